#include "io/formats/ply/splats.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include "tests/io/formats/scan_text.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;

class Splats : public testing::TextScan {
 protected:
    /// Returns an ASCII file of splats. `more` are further properties before the opacity, with the value 9
    /// each.
    static std::string file(const std::vector<std::string>& rows, const std::vector<std::string>& more = {},
                            bool flat = false) {
        std::string text = fmt::format("ply\nformat ascii 1.0\nelement vertex {}\n", rows.size());
        std::vector<std::string> names = {"x",       "y",      "z",      "nx",      "ny",      "nz",
                                          "f_dc_0",  "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1",
                                          "scale_2", "rot_0",  "rot_1",  "rot_2",   "rot_3"};
        if (flat) std::erase(names, "scale_2");
        names.insert(names.begin() + 9, more.begin(), more.end());
        for (const auto& name : names) text += fmt::format("property float {}\n", name);
        text += "end_header\n";
        std::string nines;
        for (size_t i = 0; i < more.size(); ++i) nines += "9 ";
        for (std::string row : rows) {
            const size_t at = row.find("| ");
            text += row.replace(at, 2, nines) + "\n";
        }
        return text;
    }
    glm::dvec3 triple(size_t i, std::string_view name) const {
        return {value(i, name, 0), value(i, name, 1), value(i, name, 2)};
    }
};

/// A splat at (1, 2, 3) of nearly full opacity, .2 x .3 x .01, turned by 90 degrees about x: z becomes -y.
const std::string kTurned =
    "1 2 3 0 0 0 1.7724538 0 -1.7724538 | 5 -1.6094379 -1.2039728 -4.6051702 "
    "1 1 0 0";

TEST_F(Splats, AreColouredPointsWithAnAxisAndARadius) {
    read(file({kTurned}));
    ASSERT_EQ(points(), 1u);
    EXPECT_EQ(position(0), glm::dvec3(1, 2, 3));
    EXPECT_EQ(triple(0, names::color), glm::dvec3(255, 128, 0)) << ".5 + .28209 f_dc";
    EXPECT_NEAR(value(0, "opacity"), 1 / (1 + std::exp(-5)), 1e-6);
    EXPECT_NEAR(std::abs(value(0, names::splat_axis, 1)), 1, 1e-6);
    EXPECT_NEAR(value(0, names::splat_radius), std::sqrt(2 * value(0, "opacity") * .2 * .3), 1e-5);
    EXPECT_FALSE(schema().find(names::normal)) << "trainers write zeros";
    EXPECT_THAT(source_->info().format, HasSubstr("Gaussian splats"));
    EXPECT_EQ(source_->info().color_bits, 8u);
}

TEST_F(Splats, ThatAreNearlyTransparentAreLeftOutAndCounted) {
    std::string faint = kTurned, infinite = kTurned, nan = kTurned;
    faint.replace(faint.find("| 5"), 3, "| -5");
    nan.replace(nan.find("| 5"), 3, "| nan");
    infinite.replace(infinite.find("-1.6094379"), 10, "1e30");
    read(file({faint, kTurned, nan, infinite}));
    EXPECT_EQ(points(), 2u);
    EXPECT_EQ(records_.dropped, 2u);
    EXPECT_EQ(value(1, names::splat_radius), 0) << "a scale that is no number";
    const auto contents = survey(*source_);
    ASSERT_TRUE(contents);
    EXPECT_THAT(contents->losses,
                ::testing::Contains(::testing::Field(&Loss::what, HasSubstr("transparent"))));
    read(file({faint}));
    EXPECT_EQ(points(), 0u);
}

TEST_F(Splats, ThatAreRoundHaveNoAxis) {
    std::string round = kTurned;
    round.replace(round.find("-4.6051702"), 10, "-1.6094379");
    read(file({round}));
    EXPECT_EQ(triple(0, names::splat_axis), glm::dvec3(0));
    // Splats of two dimensions are flat.
    std::string flat = kTurned;
    flat.erase(flat.find("-4.6051702 "), 11);
    read(file({flat}, {}, true));
    EXPECT_NEAR(std::abs(value(0, names::splat_axis, 1)), 1, 1e-6);
}

TEST_F(Splats, HaveNoHarmonicsAndAreNotReadWithAMillion) {
    std::vector<std::string> harmonics;
    for (int i = 0; i < 45; ++i) harmonics.push_back(fmt::format("f_rest_{}", i));
    read(file({kTurned}, harmonics));
    ASSERT_EQ(points(), 1u);
    EXPECT_EQ(schema().attributes.size(), 4u);
    for (int i = 45; i < 1'000'000 / 16; ++i) harmonics.push_back(fmt::format("f_rest_{}", i));
    EXPECT_EQ(error_of(file({kTurned}, harmonics)).kind, ErrorKind::input_rejected);
}

TEST_F(Splats, WithoutAllTheirPropertiesAreOrdinaryVertices) {
    std::string text = file({kTurned});
    text.replace(text.find("rot_3"), 5, "rot_x");
    read(text);
    EXPECT_TRUE(schema().find("f_dc_0"));
    EXPECT_TRUE(schema().find(names::normal));
}

/// Returns a file in PlayCanvas' compressed layout with 257 equal splats, so two chunks.
std::string packed(bool with_colors, uint32_t rotation, const std::string& count = "257") {
    std::string text = "ply\nformat binary_little_endian 1.0\nelement chunk 2\n";
    std::vector<std::pair<std::string, float>> bounds;
    for (const char* axis : {"x", "y", "z"}) bounds.emplace_back(std::string("min_") + axis, -1.0f);
    for (const char* axis : {"x", "y", "z"}) bounds.emplace_back(std::string("max_") + axis, 3.0f);
    for (const char* axis : {"x", "y", "z"})
        bounds.emplace_back(std::string("min_scale_") + axis, std::log(.01f));
    for (const char* axis : {"x", "y", "z"})
        bounds.emplace_back(std::string("max_scale_") + axis, std::log(.2f));
    if (with_colors) {
        for (const char* c : {"r", "g", "b"}) bounds.emplace_back(std::string("min_") + c, 0.5f);
        for (const char* c : {"r", "g", "b"}) bounds.emplace_back(std::string("max_") + c, 1.0f);
    }
    for (const auto& [name, value] : bounds) text += "property float " + name + "\n";
    text += "element vertex " + count + "\n";
    for (const char* name : {"position", "rotation", "scale", "color"})
        text += fmt::format("property uint packed_{}\n", name);
    text += "end_header\n";
    const auto put = [&](const auto& value) {
        text.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    for (int chunk = 0; chunk < 2; ++chunk)
        for (const auto& [name, value] : bounds)
            put(value + (name == "min_x" ? static_cast<float>(chunk) : 0.0f));
    for (int i = 0; i < 257; ++i) {
        put(uint32_t{0u << 21 | 1023u << 11 | 2047u});  // x least, y and z most
        put(rotation);
        put(uint32_t{2047u << 21 | 1023u << 11 | 0u});  // z is the shortest axis
        put(uint32_t{255u << 24 | 0u << 16 | 51u << 8 | (i == 5 ? 2u : 204u)});
    }
    return text;
}

TEST_F(Splats, OfTheCompressedLayoutAreTheSame) {
    constexpr uint32_t kNone = 512u << 20 | 512u << 10 | 512u;  // the first component is the largest: no turn
    for (const bool colors : {false, true}) {
        read(packed(colors, kNone));
        ASSERT_EQ(points(), 256u) << "of 257 one is transparent";
        EXPECT_NEAR(glm::length(position(0) - glm::dvec3(-1, 3, 3)), 0, 1e-5);
        EXPECT_NEAR(glm::length(position(255) - glm::dvec3(0, 3, 3)), 0, 1e-5) << "the second chunk's bounds";
        const double low = colors ? 127.5 : 0;
        EXPECT_NEAR(value(0, names::color, 0), 255, 1);
        EXPECT_NEAR(value(0, names::color, 1), low, 1);
        EXPECT_NEAR(value(0, names::color, 2), low + (255 - low) / 5, 1);
        EXPECT_NEAR(value(0, "opacity"), .8, 1e-6);
        EXPECT_NEAR(value(0, names::splat_radius), std::sqrt(2 * .8 * .2 * .2), 1e-5);
        EXPECT_NEAR(std::abs(value(0, names::splat_axis, 2)), 1, 1e-3);
    }
    // A quarter turn about x, (w, x, y, z) = (.7071, .7071, 0, 0): w is the largest, x is its share of 1.
    read(packed(true, 1023u << 20 | 512u << 10 | 512u));
    EXPECT_NEAR(std::abs(value(0, names::splat_axis, 1)), 1, 1e-2);
    // Any points, by their places.
    PointBatch batch;
    const std::vector<uint64_t> indices = {0, 5, 255, 256};
    ASSERT_TRUE(source_->pick(indices, batch));
    ASSERT_EQ(batch.count, 3u);
    EXPECT_NEAR(position_of(schema(), &batch.bytes[2 * schema().stride]).x, 0, 1e-5);
}

TEST_F(Splats, OfTheCompressedLayoutThatAreCutOffAreRejectedOrSaved) {
    std::string cut = packed(true, 0);
    cut.resize(cut.size() - 8);
    EXPECT_THAT(error_of(cut).line(), HasSubstr("truncated"));
    ReadOptions salvage{.quiet = true};
    salvage.salvage = true;
    read(cut, salvage);
    EXPECT_EQ(points(), 255u);
    for (const char* count : {"9223372036854775808", "18446744073709551615", "513"}) {
        EXPECT_EQ(error_of(packed(true, 0, count)).kind, ErrorKind::input_rejected) << count;
        (void)error_of(packed(true, 0, count), salvage);
    }
    std::string ascii = packed(true, 0);
    ascii.replace(ascii.find("binary_little_endian"), 20, "binary_big_endian");
    EXPECT_THAT(error_of(ascii).line(), HasSubstr("little-endian"));
}

TEST_F(Splats, OfReportedFilesAreRead) {
    if (testing::shared_data().empty()) GTEST_SKIP() << "the shared data is not here";
    for (const char* name : {"splat3dgs.ply", "splat_compressed.ply"}) {
        read(testing::read_bytes(testing::shared_data() / "reports" / name));
        EXPECT_GT(points(), 100u) << name;
        EXPECT_LE(points(), 300u) << name;
        EXPECT_TRUE(schema().find(names::color) && schema().find(names::splat_axis)) << name;
    }
}

}  // namespace
}  // namespace lucarne::io
