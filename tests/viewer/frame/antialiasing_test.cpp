// Averages of frames, whose rays pass through other places of their pixels, against the outlines that were
// drawn.
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/scene/views.h"
#include "tests/gi/raster/drawn_surfels.h"

namespace lucarne::gi {
namespace {

constexpr uint32_t kSide = 48;

/// Returns a narrow view: small discs are drawn to first order in their radius over their depth.
CameraView view_of(uint32_t side) {
    return look({0, 0, 0}, {0, 1, 0}, side, side, 0.1f);
}

class Antialiasing : public GBufferTest {
 protected:
    /// Returns the share of `frames` frames in which each pixel shows the disc.
    std::vector<double> averaged(const Surfel& disc, uint32_t frames) {
        std::vector<double> mean(kSide * kSide);
        for (uint32_t frame = 0; frame < frames; ++frame) {
            CameraView view = view_of(kSide);
            gi::shift_rays(view, frame);
            const Picture p = draw({disc}, view);
            for (size_t at = 0; at < mean.size(); ++at) mean[at] += (p.empty(at) ? 0.0 : 1.0) / frames;
        }
        return mean;
    }
    /// Returns the share of each pixel's area that the disc covers, by 32 x 32 rays.
    std::vector<double> truth(const Surfel& disc) {
        constexpr uint32_t kRays = 32;
        const Picture drawn = draw({disc}, view_of(kSide));
        Picture fine{view_of(kSide * kRays), {}, {}, {}};
        const Surfel& s = drawn.surfels.at(0);  // as it is stored
        std::vector<double> coverage(kSide * kSide);
        for (uint32_t y = 0; y < kSide * kRays; ++y)
            for (uint32_t x = 0; x < kSide * kRays; ++x) {
                const glm::vec3 ray = fine.ray(x, y);
                const glm::vec3 hit = ray * (glm::dot(s.normal, s.position) / glm::dot(s.normal, ray));
                if (glm::distance(hit, s.position) < s.radius)
                    coverage[y / kRays * kSide + x / kRays] += 1.0 / (kRays * kRays);
            }
        return coverage;
    }
};

/// Returns the root mean square of the differences in the pixels that the outline crosses.
double error(const std::vector<double>& coverage, const std::vector<double>& truth) {
    double sum = 0, count = 0;
    for (size_t at = 0; at < truth.size(); ++at) {
        if (truth[at] <= 0 || truth[at] >= 1) {
            EXPECT_NEAR(coverage[at], truth[at], 0.05) << at;
            continue;
        }
        sum += std::pow(coverage[at] - truth[at], 2);
        ++count;
    }
    EXPECT_GT(count, 10);
    return std::sqrt(sum / count);
}

TEST_P(Antialiasing, AveragesConvergeToTheCoverageOfAnOutline) {
    for (const float area : {2.2e-4f, 2e-3f}) {  // drawn as a small disc and as a large one
        const Surfel disc{{0.01f, 3, 0.005f}, glm::normalize(glm::vec3(1, -2, 0.7f)), kWhite, 0, area, 0};
        const auto coverage = truth(disc);
        EXPECT_GT(error(averaged(disc, 1), coverage), 0.2);
        EXPECT_LT(error(averaged(disc, 16), coverage), 0.08);
        EXPECT_LT(error(averaged(disc, 64), coverage), 0.04);
    }
}

INSTANTIATE_TEST_SUITE_P(Passes, Antialiasing, ::testing::Bool(), passes_name);

TEST(RayShift, FirstFrameIsThatOfASinglePicture) {
    const CameraView single = view_of(kSide);
    CameraView first = single;
    gi::shift_rays(first, 7);
    EXPECT_NE(first, single);
    EXPECT_LE(std::max(std::abs(first.right.w), std::abs(first.up.w)), 0.5f);
    gi::shift_rays(first, 0);
    EXPECT_EQ(first, single);
}

}  // namespace
}  // namespace lucarne::gi
