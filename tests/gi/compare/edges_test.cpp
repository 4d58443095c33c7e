#include "gi/compare/edges.h"

#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/compare/error_picture.h"

namespace lucarne::gi {
namespace {

constexpr uint32_t kSide = 20;
const glm::vec3 kTowards(0, 0, 1);

/// Returns a G-buffer with normal and depth by column, the same in every row.
template <class Texel>
io::Image columns(const Texel& texel) {
    io::Image image{kSide, kSide, {}};
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x) image.pixels.push_back(texel(x));
    return image;
}
glm::vec4 texel(const glm::vec3& normal, double depth) {
    return {normal, static_cast<float>(depth)};
}

/// Returns which columns are marked; every row must be alike.
std::vector<uint32_t> marked(const std::vector<uint8_t>& mask) {
    std::vector<uint32_t> result;
    for (uint32_t x = 0; x < kSide; ++x) {
        for (uint32_t y = 1; y < kSide; ++y) EXPECT_EQ(mask[y * kSide + x], mask[x]) << x;
        if (mask[x]) result.push_back(x);
    }
    return result;
}
using Columns = std::vector<uint32_t>;

TEST(Edges, APlaneHasNoneHoweverSteepItIs) {
    // A plane's 1/z is linear in the pixels: here from 1 m to 20 m over 20 pixels.
    const auto plane = columns([](uint32_t x) { return texel(kTowards, 20.0 / (x + 1)); });
    EXPECT_EQ(marked(gbuffer_edges(plane)), Columns());
}

TEST(Edges, AStepInDepthMarksBothSidesAndTheirNeighbours) {
    const auto step = columns([](uint32_t x) { return texel(kTowards, x < 10 ? 5.0 : 6.0); });
    EXPECT_EQ(marked(gbuffer_edges(step)), (Columns{8, 9, 10, 11}));
    const auto noise = columns([](uint32_t x) { return texel(kTowards, 5.0 + 0.01 * (x % 2)); });
    EXPECT_EQ(marked(gbuffer_edges(noise)), Columns());
}

TEST(Edges, ACornerOfWallsIsAnEdgeAndACurveIsNone) {
    const glm::vec3 side(1, 0, 0);
    const auto corner = columns([&](uint32_t x) { return texel(x < 10 ? kTowards : side, 5.0); });
    EXPECT_EQ(marked(gbuffer_edges(corner)), (Columns{8, 9, 10, 11}));
    const auto column = columns([&](uint32_t x) {
        const float angle = 0.1f * static_cast<float>(x);
        return texel({std::sin(angle), 0, std::cos(angle)}, 5.0);
    });
    EXPECT_EQ(marked(gbuffer_edges(column)), Columns());
}

TEST(Edges, TheBorderOfWhatIsSeenIsAnEdge) {
    for (const double nothing : {0.0, std::nan(""), -1.0}) {
        const auto half = columns([&](uint32_t x) { return texel(kTowards, x < 5 ? nothing : 3.0); });
        EXPECT_EQ(marked(gbuffer_edges(half)), (Columns{3, 4, 5, 6}));
    }
    const auto empty = columns([](uint32_t) { return glm::vec4(0); });
    EXPECT_EQ(marked(gbuffer_edges(empty)), Columns());
}

TEST(Edges, RowsAreEdgesAsColumnsAre) {
    io::Image image{3, kSide, {}};
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < 3; ++x) image.pixels.push_back(texel(kTowards, y < 10 ? 5.0 : 6.0));
    const auto mask = gbuffer_edges(image);
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < 3; ++x) EXPECT_EQ(mask[y * 3 + x], y >= 8 && y < 12) << x << " " << y;
}

TEST(Edges, OfLuminanceAreStepsAndNeitherNoiseNorDarkness) {
    const auto level = [](float value) { return glm::vec4(value, value, value, 1); };
    const auto shadow = columns([&](uint32_t x) { return level(x < 10 ? 1.0f : 0.5f); });
    EXPECT_EQ(marked(luminance_edges(shadow)), (Columns{8, 9, 10, 11}));
    const auto noise = columns([&](uint32_t x) { return level(x % 2 ? 1.0f : 0.9f); });
    EXPECT_EQ(marked(luminance_edges(noise)), Columns());
    const auto dark = columns([&](uint32_t x) { return level(x < 10 ? (x % 2 ? 0.004f : 0.0f) : 0.2f); });
    EXPECT_EQ(marked(luminance_edges(dark)), (Columns{8, 9, 10, 11}));
}

TEST(Edges, PicturesOfOnePixelOrOneLineWork) {
    EXPECT_EQ(gbuffer_edges({1, 1, {texel(kTowards, 1)}}), (std::vector<uint8_t>{0}));
    const io::Image row{4, 1, {texel(kTowards, 1), texel(kTowards, 1), glm::vec4(0), glm::vec4(0)}};
    EXPECT_EQ(gbuffer_edges(row), (std::vector<uint8_t>{1, 1, 1, 1}));
    const io::Image column{1, 4, row.pixels};
    EXPECT_EQ(gbuffer_edges(column), (std::vector<uint8_t>{1, 1, 1, 1}));
}

TEST(ErrorPicture, MagmaRunsFromBlackToPaleYellow) {
    const auto picture = magma_picture(std::vector<float>{0, 0.5f, 1, 7}, 2);
    EXPECT_EQ(picture.width, 2u);
    EXPECT_EQ(picture.height, 2u);
    const uint8_t magma[4][3] = {
        {0, 0, 4}, {183, 55, 121}, {252, 253, 191}, {252, 253, 191}};  // matplotlib's
    for (size_t i = 0; i < 4; ++i)
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(picture.bytes[3 * i + c], magma[i][c], 5) << i << " " << c;
}

TEST(ErrorPicture, SignTellsTooBrightFromTooDark) {
    const auto level = [](float value) { return glm::vec4(value, value, value, 1); };
    const io::Image reference{3, 1, {level(1), level(1), level(1)}};
    const auto picture = signed_picture({3, 1, {level(1), level(4), level(0)}}, reference);
    EXPECT_EQ(picture.bytes[0], 255);
    EXPECT_EQ(picture.bytes[2], 255);
    EXPECT_GT(picture.bytes[3], picture.bytes[5] + 100);  // red
    EXPECT_GT(picture.bytes[8], picture.bytes[6] + 100);  // blue
}

}  // namespace
}  // namespace lucarne::gi
