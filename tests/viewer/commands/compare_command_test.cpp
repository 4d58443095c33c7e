#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/image/image.h"
#include "tests/viewer/program.h"

namespace lucarne {
namespace {

using test::Outcome, testing::HasSubstr;

class CompareCommand : public testing::Test {
 protected:
    std::string at(const std::string& name) { return folder_ / name; }
    /// Writes a ramp with a step in the middle, multiplied by `change(x, y)`.
    template <class Change>
    void write(const std::string& name, const Change& change, uint32_t width = 40, uint32_t height = 30) {
        io::Image image{width, height, {}};
        for (uint32_t y = 0; y < height; ++y)
            for (uint32_t x = 0; x < width; ++x) {
                const float level = (x < width / 2 ? 0.2f : 1.0f) + 0.01f * static_cast<float>(y);
                image.pixels.push_back(glm::vec4(level, level, level, 1) * static_cast<float>(change(x, y)));
            }
        ASSERT_TRUE(io::write_exr(at(name), image, true));
    }
    void write(const std::string& name, double factor = 1) {
        write(name, [&](uint32_t, uint32_t) { return factor; });
    }
    Outcome compare(const std::string& arguments) { return test::lucarne("compare " + arguments); }
    nlohmann::json figures(const std::string& arguments) {
        const Outcome ran = compare(arguments + " --overwrite --json " + at("figures.json"));
        EXPECT_EQ(ran.code, 0) << ran.output;
        return nlohmann::json::parse(test::bytes_of(at("figures.json")));
    }

    test::TemporaryFolder folder_;
};

TEST_F(CompareCommand, EqualPicturesHaveNoError) {
    write("a.exr");
    const auto same = figures(at("a.exr") + " " + at("a.exr"));
    for (const char* name : {"luminance_error", "rel_mse", "rel_mse_trimmed", "rmse", "p99", "flip"}) {
        EXPECT_EQ(same[name], 0.0) << name;
        EXPECT_EQ(same["edges"][name], 0.0) << name;
    }
}

TEST_F(CompareCommand, AnErrorAtTheStepIsLargerThereThanInTheMean) {
    write("a.exr", [](uint32_t x, uint32_t) { return x == 19 || x == 20 ? 1.5 : 1.0; });
    write("b.exr");
    const auto report = figures(at("a.exr") + " " + at("b.exr"));
    const auto& edges = report["edges"];
    EXPECT_EQ(edges["from"], "luminance");
    EXPECT_EQ(edges["pixels"], 4 * 30);
    EXPECT_NEAR(double(edges["rel_mse"]), 10 * double(report["rel_mse"]), 1e-4);
    EXPECT_GT(edges["flip"], report["flip"]);
    EXPECT_GT(report["flip"], 0.0);
}

TEST_F(CompareCommand, FlipSeesADarkPictureAsDark) {
    write("a.exr", 0.25);
    write("b.exr");
    EXPECT_GT(figures(at("a.exr") + " " + at("b.exr"))["flip"], 0.2);
    // At an exposure that turns both black, they look the same.
    EXPECT_LT(figures(at("a.exr") + " " + at("b.exr") + " --exposure -30")["flip"], 0.01);
}

TEST_F(CompareCommand, HalvesStandForTheReferenceAndFreeTheErrorFromItsNoise) {
    const auto noisy = [](uint32_t x, uint32_t y, uint32_t salt) {
        const uint32_t hash = ((x * 73856093u) ^ (y * 19349663u) ^ (salt * 83492791u)) * 2654435761u;
        return 1 + 0.2 * ((hash >> 8) / 16777216.0 - 0.5);
    };
    write("r1.exr", [&](uint32_t x, uint32_t y) { return noisy(x, y, 1); });
    write("r2.exr", [&](uint32_t x, uint32_t y) { return noisy(x, y, 2); });
    write("a.exr", 1.02);
    const auto report = figures(at("a.exr") + " --halves " + at("r1.exr") + " " + at("r2.exr"));
    const double free = report["halves"]["rel_mse"], error = report["halves"]["standard_error"];
    EXPECT_NEAR(free, 0.02 * 0.02, 4 * error);
    EXPECT_GT(report["rel_mse"], 3 * free);
    EXPECT_FALSE(figures(at("a.exr") + " " + at("r1.exr")).contains("halves"));
}

TEST_F(CompareCommand, ErrorPicturesShowWhereAndWhichWay) {
    write("a.exr", [](uint32_t x, uint32_t) { return x < 10 ? 3.0 : 1.0; });
    write("b.exr");
    const std::string both = at("a.exr") + " " + at("b.exr") + " --error-picture ";
    ASSERT_EQ(compare(both + at("flip.png")).code, 0);
    ASSERT_EQ(compare(both + at("signed.png") + " --error-kind signed").code, 0);
    const auto flip = io::read_png(at("flip.png")), sign = io::read_png(at("signed.png"));
    ASSERT_TRUE(flip && sign);
    const auto pixel = [](const io::Image8& image, uint32_t x) { return &image.bytes[3 * (15 * 40 + x)]; };
    EXPECT_GT(pixel(*flip, 2)[0], 100);  // orange
    EXPECT_LT(pixel(*flip, 38)[0], 5);   // black
    EXPECT_GT(pixel(*sign, 2)[0], pixel(*sign, 2)[2] + 100);
    EXPECT_EQ(pixel(*sign, 38)[2], 255);
    EXPECT_EQ(compare(both + at("flip.png")).code, 1) << "what exists is kept";
}

TEST_F(CompareCommand, WhatCannotBeComparedIsRejectedWithAReason) {
    write("a.exr");
    write(
        "small.exr", [](uint32_t, uint32_t) { return 1.0; }, 20, 30);
    write("nan.exr", [](uint32_t x, uint32_t y) { return y == 3 && x > 37 ? std::nan("") : 1.0; });
    const std::string a = at("a.exr") + " ";
    const Outcome small = compare(a + at("small.exr"));
    EXPECT_EQ(small.code, 3);
    EXPECT_THAT(small.output, HasSubstr("is 20x30, the first picture 40x30"));
    const Outcome nan = compare(a + at("nan.exr"));
    EXPECT_EQ(nan.code, 3);
    EXPECT_THAT(nan.output,
                HasSubstr("2 of 1200 pixels are no finite radiance, the first at column 38, row 3"));
    EXPECT_EQ(compare(a + "--halves " + a + at("nan.exr")).code, 3);
    std::ofstream(at("text.exr")) << "no picture";
    EXPECT_EQ(compare(a + at("text.exr")).code, 3);
    EXPECT_EQ(compare(a + at("missing.exr")).code, 3);
    EXPECT_EQ(compare(a).code, 2);
    EXPECT_EQ(compare(a + a + "--error-kind wrong").code, 2);
    EXPECT_EQ(compare(a + a + "--halves " + a).code, 2);
}

}  // namespace
}  // namespace lucarne
