// Edges in single pictures against averages of many frames, of a virtual scan that is lit.
#include <algorithm>
#include <cmath>

#include "tests/viewer/frame/with_cornell.h"
#include "viewer/frame/pipeline.h"

namespace lucarne::viewer {
namespace {

constexpr uint32_t kWidth = 160, kHeight = 120;
using Light = std::vector<glm::vec4>;

double luminance(const glm::vec4& light) {
    return 0.2126 * light.x + 0.7152 * light.y + 0.0722 * light.z;
}

/// Returns the root mean square of the differences of luminance, each as the screen would show it:
/// compressed.
double difference(const Light& a, const Light& b, double white) {
    double sum = 0;
    const auto shown = [&](const glm::vec4& light) {
        return std::pow(std::min(luminance(light) / white, 1.0), 1 / 2.2);
    };
    for (size_t i = 0; i < a.size(); ++i) sum += std::pow(shown(a[i]) - shown(b[i]), 2);
    return std::sqrt(sum / static_cast<double>(a.size()));
}

/// Pictures of a scan of the primitives: boxes, balls, a cylinder and a cone, under one lamp.
class EdgesTest : public test::WithCornell {
 protected:
    void SetUp() override {
        WithCornell::SetUp();
        if (HasFatalFailure()) return;
        const std::string scan = folder_ / "solids.las", cache = folder_ / "solids.luc";
        ASSERT_EQ(test::lucarne("generate primitives --points 120k -o " + scan).code, 0);
        ASSERT_EQ(test::lucarne("convert " + scan + " -o " + cache).code, 0);
        const auto source = open_input(cache);
        ASSERT_TRUE(source) << source.error().line();
        auto pipeline = Pipeline::open(*device_, *source, {});
        ASSERT_TRUE(pipeline) << pipeline.error().line();
        pipeline_ = std::move(*pipeline);
        ASSERT_TRUE(pipeline_->set_engine("direct"));
        const auto& header = (*source)->header();
        const glm::dvec3 middle = (header.min + header.max) / 2.0, size = header.max - header.min;
        gi::Scene scene = pipeline_->scene();
        scene.lights.resize(1);
        scene.lights[0].position = middle + glm::dvec3(-0.3, -0.5, 1.5) * size;
        ASSERT_TRUE(pipeline_->set_scene(scene));
        request_.size = {kWidth, kHeight};
        request_.wait = true;
        request_.camera.position = middle + glm::dvec3(0.1, -0.7, 0.5) * size;
        request_.camera.target = middle;
        request_.camera.vertical_fov = 0.8;
    }
    Light render() {
        const auto stats = pipeline_->render(request_);
        EXPECT_TRUE(stats) << stats.error().line();
        return pipeline_->radiance().download_all<glm::vec4>(size_t{kWidth} * kHeight);
    }
    std::unique_ptr<Pipeline> pipeline_;
    FrameRequest request_;
};

TEST_F(EdgesTest, OfOnePictureAreThoseOfAnAverage) {
    request_.antialiased = false;
    const Light hard = render();
    request_.antialiased = true;
    const Light soft = render();
    request_.accumulate = true;
    Light mean;
    constexpr int kFrames = 32;
    for (int frame = 0; frame < kFrames; ++frame) mean = render();
    double white = 0;
    for (const glm::vec4& light : mean) white = std::max(white, luminance(light));
    ASSERT_GT(white, 0);
    // Edges of shadows stay hard.
    EXPECT_LT(difference(soft, mean, white), 0.8 * difference(hard, mean, white));
    // No dashes: fewer pixels are much darker than in the average.
    size_t dark_before = 0, dark = 0;
    for (size_t i = 0; i < mean.size(); ++i) {
        if (luminance(mean[i]) < 0.05 * white) continue;
        dark_before += luminance(hard[i]) < 0.5 * luminance(mean[i]);
        dark += luminance(soft[i]) < 0.5 * luminance(mean[i]);
    }
    EXPECT_LE(4 * dark, 3 * dark_before);
}

TEST_F(EdgesTest, TheFirstFrameOfAnAverageIsThePictureAlone) {
    const Light alone = render();
    request_.accumulate = true;
    EXPECT_EQ(render(), alone);
    EXPECT_NE(render(), alone);
    // A frame of a motion is not continued.
    request_.accumulate = false;
    EXPECT_EQ(render(), alone);
    request_.accumulate = true;
    EXPECT_EQ(render(), alone);
}

TEST_F(EdgesTest, OpacityIsTheShareOfThePixelThatShowsPoints) {
    request_.transparent = true;
    render();
    const auto points = pipeline_->points_radiance();
    const auto partly = std::ranges::count_if(
        points, [](const glm::vec4& light) { return light.w > 0.01f && light.w < 0.99f; });
    EXPECT_GT(partly, 50);
    request_.antialiased = false;
    render();
    for (const glm::vec4& light : pipeline_->points_radiance()) EXPECT_TRUE(light.w == 0 || light.w == 1);
}

}  // namespace
}  // namespace lucarne::viewer
