#include "viewer/opening/colour_cast.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gi/shared/luminance.h"
#include "gi/shared/surfel_code.h"

namespace lucarne::viewer {
namespace {

io::Schema colours() {
    io::Schema schema;
    schema.add(std::string(io::names::color), io::ScalarType::f32, 3);
    return schema;
}

/// What is found in points with these sRGB-coded colours, of 255.
ColourCast found_in(std::initializer_list<glm::vec3> points) {
    const io::Schema schema = colours();
    ColourCast cast;
    for (const glm::vec3& colour : points) {
        std::vector<std::byte> record(schema.stride);
        std::memcpy(&record[schema.find(io::names::color)->offset], &colour, sizeof colour);
        cast.add(schema, record.data(), 255);
    }
    return cast;
}
glm::dvec3 cast_of(std::initializer_list<glm::vec3> points) {
    return found_in(points).result();
}

TEST(ColourCast, GreyPointsHaveNone) {
    const glm::dvec3 cast = cast_of({{20, 20, 20}, {200, 200, 200}});
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(cast[c], 1, 1e-6);
}

TEST(ColourCast, WarmLightIsFoundInPart) {
    const glm::dvec3 cast = cast_of({{200, 150, 90}, {80, 60, 35}});
    EXPECT_GT(cast.x, 1.1 * cast.y);
    EXPECT_GT(cast.y, 1.1 * cast.z);
    EXPECT_NEAR(gi::luminance(cast), 1, 1e-9);
    const double linear_ratio =
        std::pow((200 + 14.025) / (90 + 14.025), 2.4);  // IEC 61966-2-1, 14.025 of 255
    EXPECT_LT(cast.x / cast.z, linear_ratio);
}

TEST(ColourCast, MoreOfAStrongColourThanOfAWeakOneIsLight) {
    const auto share = [](uint8_t blue) {
        const glm::dvec3 cast = cast_of({{200, 200, blue}});
        return std::log(cast.x / cast.z) / std::log(gi::srgb_to_linear(200 / 255.0f) /
                                                    gi::srgb_to_linear(static_cast<float>(blue) / 255));
    };
    EXPECT_NEAR(share(160), .6, .001);   // 1.7 times
    EXPECT_NEAR(share(100), .85, .001);  // 4.5 times
    EXPECT_GT(share(120), .61);
    EXPECT_LT(share(120), .84);
}

TEST(ColourCast, DarkColoursAreToBeShownBrighterWithinBounds) {
    EXPECT_EQ(found_in({{200, 190, 180}, {90, 100, 110}}).brightness(), 1);
    const double dark = found_in({{80, 80, 80}, {60, 60, 60}}).brightness();
    EXPECT_GT(dark, 1.5);
    EXPECT_LT(dark, kMostBrightness);
    EXPECT_EQ(found_in({{9, 9, 9}}).brightness(), kMostBrightness);
    for (const auto& none : {found_in({}), found_in({{0, 0, 0}})}) EXPECT_EQ(none.brightness(), 1);
}

TEST(ColourCast, IsBoundedAndWhiteWithoutColours) {
    const glm::dvec3 red = cast_of({{255, 0, 0}});
    EXPECT_LE(red.x / red.z, 4.0);
    EXPECT_EQ(cast_of({}), glm::dvec3(1));
    EXPECT_EQ(cast_of({{0, 0, 0}}), glm::dvec3(1)) << "never photographed";
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(cast_of({{kNone, 0, 0}, {-1, 0, 5}, {256, 9, 9}}), glm::dvec3(1));
    const io::Schema without;
    ColourCast cast;
    cast.add(without, nullptr, 255);
    EXPECT_EQ(cast.result(), glm::dvec3(1));
}

}  // namespace
}  // namespace lucarne::viewer
