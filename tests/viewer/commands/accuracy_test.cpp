// Compares pictures of an engine with the reference's, from the same scan and through the same pipeline.
#include <cmath>
#include <cstdio>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "gi/compare/metrics.h"
#include "io/image/image.h"
#include "tests/viewer/program.h"

namespace lucarne {
namespace {

constexpr double kTolerance = 0.05;  // of the mean luminance, relative

struct Case {
    const char* scene;
    const char* points;
};

class Accuracy : public testing::TestWithParam<Case> {
 protected:
    void SetUp() override {
        const auto [scene, points] = GetParam();
        cache_ = folder_ / "cache.luc";
        const std::string scan = folder_ / "scan.ply";
        ASSERT_EQ(test::lucarne(std::string("generate ") + scene + " --even --normals --points " + points +
                                " -o " + scan)
                      .code,
                  0);
        ASSERT_EQ(test::lucarne("convert " + scan + " -o " + cache_).code, 0);
    }

    struct Picture {
        io::Image radiance;
        double standard_error = 0;
    };
    Picture render(const std::string& arguments) {
        const std::string picture = folder_ / "picture.exr", figures = folder_ / "figures.json";
        const auto ran =
            test::lucarne("render " + cache_ + " -o " + picture + " --scene " + LUCARNE_SOURCE_DIR +
                          "/data/scenes/" + GetParam().scene +
                          ".json --preset high --size 96x72 --overwrite --json " + figures + " " + arguments);
        EXPECT_EQ(ran.code, 0) << ran.output;
        auto image = io::read_exr(picture);
        EXPECT_TRUE(image) << image.error().line();
        return {std::move(*image), nlohmann::json::parse(test::bytes_of(figures))["standard_error"]};
    }

    test::TemporaryFolder folder_;
    std::string cache_;
};

void expect_agreement(const std::string& what, const io::Image& picture, const io::Image& truth,
                      double standard_error) {
    const auto metrics = gi::compare_images(picture.pixels, truth.pixels);
    ASSERT_TRUE(metrics) << metrics.error().line();
    std::printf("%s: mean luminance %.5f against %.5f +- %.5f (%+.2f %%), relMSE %.4f\n", what.c_str(),
                metrics->mean_luminance, metrics->reference_mean_luminance, standard_error,
                100 * metrics->luminance_error, metrics->rel_mse);
    EXPECT_LT(standard_error, kTolerance / 5 * metrics->reference_mean_luminance) << what;
    EXPECT_LT(std::abs(metrics->luminance_error), kTolerance) << what;
}

TEST_P(Accuracy, DirectLightAgreesWithTheReference) {
    const Picture truth = render("--engine reference --only-bounce 0");
    expect_agreement("direct light", render("--engine direct --only-bounce 0").radiance, truth.radiance, 0);
}

TEST_P(Accuracy, VplOneBounceAgreesWithTheReference) {
    const Picture truth = render("--engine reference --bounces 1 --samples 256");
    expect_agreement("one bounce", render("--engine vpl --bounces 1").radiance, truth.radiance,
                     truth.standard_error);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Accuracy, testing::Values(Case{"cornell", "300k"}, Case{"nave", "600k"}),
                         [](const auto& tested) { return std::string(tested.param.scene); });

}  // namespace
}  // namespace lucarne
