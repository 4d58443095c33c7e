// Coverage of pixels at edges: in single pictures against the outlines that were drawn, and against averages
// of pictures whose rays pass through other places of their pixels.
#include "gi/raster/coverage.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/post/share_edges.h"
#include "gi/raster/coverage_code.h"
#include "gi/raster/native/native.h"
#include "gi/raster/rims.h"
#include "gi/scene/views.h"
#include "io/core/parallel.h"
#include "tests/gi/raster/drawn_surfels.h"

namespace lucarne::gi {
namespace {

using raster::kCoverageNeighbours, raster::kCoverageSamples;

TEST(CoverageCode, SamplesLieInOneRowAndColumnEachAndNeighboursFaceEachOther) {
    std::array<int, 8> rows{}, columns{};
    glm::vec2 sum(0);
    for (uint32_t i = 0; i < kCoverageSamples; ++i) {
        const glm::vec2 at = raster::coverage_sample(i);
        ++columns.at(static_cast<size_t>(std::floor((at.x + 0.5f) * 8)));
        ++rows.at(static_cast<size_t>(std::floor((at.y + 0.5f) * 8)));
        sum += at;
    }
    for (const int count : rows) EXPECT_EQ(count, 1);
    for (const int count : columns) EXPECT_EQ(count, 1);
    EXPECT_EQ(sum, glm::vec2(0)) << "so that no outline moves";
    for (uint32_t i = 0; i < kCoverageNeighbours; ++i)
        EXPECT_EQ(raster::coverage_neighbour(i), -raster::coverage_neighbour(kCoverageNeighbours - 1 - i));
}

/// A picture of a scene, one channel of its light being the albedo.
class Coverage : public GBufferTest {
 protected:
    void load(const std::vector<Surfel>& surfels) {
        const SurfelCloud cloud(surfels, {{-32, -32, -32}, 64}, 1024);
        auto loaded = load_cloud(*device, cloud);
        ASSERT_TRUE(loaded) << loaded.error().line();
        loaded_ = std::move(*loaded);
    }
    void draw(const CameraView& view) {
        ASSERT_TRUE(rasterize(*device, loaded_->cut, view, target_));
        ASSERT_TRUE(blend(*device, loaded_->cut, view, target_));
        ASSERT_TRUE(turn_rims(*device, view, target_));
        ASSERT_TRUE(find_coverage(*device, loaded_->cut, view, target_));
    }
    std::vector<uint32_t> words() const {
        return target_.coverage.download_all<uint32_t>(size_t{target_.width} * target_.height);
    }
    /// Returns the albedo of each pixel; with `soft` edges they are shared. w: the share that shows points.
    std::vector<glm::vec4> albedo(bool soft, bool points_only = false) {
        const size_t pixels = size_t{target_.width} * target_.height;
        const auto texels = target_.texels.download_all<GBufferTexel>(pixels);
        std::vector<glm::vec4> light(pixels);
        for (size_t at = 0; at < pixels; ++at)
            light[at] = texels[at].depth == 0 ? glm::vec4(0.5f, 0.5f, 0.5f, 0)
                                              : glm::vec4(decode_albedo(texels[at].albedo), 1);
        if (!soft) return light;
        Buffer sample, mean;
        EXPECT_TRUE(device->reserve(sample, pixels * sizeof(glm::vec4), "light"));
        EXPECT_TRUE(device->reserve(mean, pixels * sizeof(glm::vec4), "light"));
        sample.upload_all(light);
        EXPECT_TRUE(share_edges(*device, sample, target_, points_only, mean));
        return mean.download_all<glm::vec4>(pixels);
    }

    std::unique_ptr<LoadedCloud> loaded_;
    GBuffer target_;
};

double difference(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
    double sum = 0;
    for (size_t at = 0; at < a.size(); ++at) {
        const glm::vec4 apart = a[at] - b[at];
        sum += glm::dot(apart, apart);
    }
    return std::sqrt(sum / static_cast<double>(a.size()));
}

/// A round post and a tilted board before a wall that ends within the view.
std::vector<Surfel> posts(float spacing) {
    auto surfels = wall(4, 1.2f, spacing, kWhite, 3);
    auto board = wall(0, 0.4f, spacing, kRed, 5);
    for (Surfel& s : board) {
        const float turn = 0.3f;
        const auto turned = [&](const glm::vec3& v) {
            return glm::vec3(v.x * std::cos(turn) - v.z * std::sin(turn), v.y,
                             v.x * std::sin(turn) + v.z * std::cos(turn));
        };
        s.position = turned(s.position) + glm::vec3(-0.5f, 2.5f, 0);
        s.normal = turned(s.normal);
    }
    append(surfels, board);
    std::mt19937 random(6);
    std::uniform_real_distribution<float> jitter(-0.5f, 0.5f);
    const float radius = 0.15f;
    for (float turn = 0; turn < 6.2831f; turn += spacing / radius)
        for (float z = -1; z <= 1; z += spacing) {
            const float along = jitter(random), up = jitter(random);
            const float angle = turn + along * spacing / radius;
            const glm::vec3 normal(std::cos(angle), std::sin(angle), 0);
            surfels.push_back({glm::vec3(0.4f, 3, z + up * spacing) + radius * normal,
                               normal,
                               {0.1f, 0.3f, 0.8f},
                               0,
                               spacing * spacing,
                               0});
        }
    return surfels;
}

TEST_P(Coverage, OnePictureHasTheEdgesOfAnAverageOfMany) {
    for (const float spacing : {0.015f, 0.05f}) {  // small discs and large ones
        load(posts(spacing));
        CameraView view = look({0, 0, 0}, {0, 1, 0}, 200, 150, 0.9f);
        std::vector<glm::vec4> mean(size_t{view.width} * view.height, glm::vec4(0));
        constexpr int kFrames = 64;
        for (int frame = 0; frame < kFrames; ++frame) {
            shift_rays(view, static_cast<uint32_t>(frame));
            draw(view);
            const auto hard = albedo(false);
            for (size_t at = 0; at < mean.size(); ++at) mean[at] += hard[at] / static_cast<float>(kFrames);
        }
        shift_rays(view, 0);
        draw(view);
        const double before = difference(albedo(false), mean), now = difference(albedo(true), mean);
        EXPECT_LT(now, 0.5 * before) << spacing;
        RecordProperty("share", std::to_string(now / before));
    }
}

TEST_P(Coverage, TheOutlineOfADiscHasTheShareOfItsArea) {
    // The disc covers a quarter of a radian's height; seen against nothing.
    const Surfel disc{{0.01f, 3, 0.005f}, glm::normalize(glm::vec3(1, -2, 0.7f)), kWhite, 0, 2e-3f, 0};
    load({disc});
    const CameraView view = look({0, 0, 0}, {0, 1, 0}, 48, 48, 0.1f);
    draw(view);
    const auto light = albedo(true);
    // Rays through 16 x 16 places of each pixel.
    constexpr uint32_t kRays = 16;
    const Picture fine{look({0, 0, 0}, {0, 1, 0}, 48 * kRays, 48 * kRays, 0.1f), {}, {}, {}};
    const Surfel s = loaded_->pool.download(loaded_->cut).at(0);
    std::vector<double> truth(48 * 48);
    for (uint32_t y = 0; y < 48 * kRays; ++y)
        for (uint32_t x = 0; x < 48 * kRays; ++x) {
            const glm::vec3 ray = fine.ray(x, y);
            const glm::vec3 hit = ray * (glm::dot(s.normal, s.position) / glm::dot(s.normal, ray));
            if (glm::distance(hit, s.position) < s.radius)
                truth[y / kRays * 48 + x / kRays] += 1.0 / (kRays * kRays);
        }
    double sum = 0, count = 0, drawn = 0, real = 0;
    for (size_t at = 0; at < truth.size(); ++at) {
        drawn += light[at].w;
        real += truth[at];
        if (truth[at] <= 0 || truth[at] >= 1) continue;
        sum += std::pow(light[at].w - truth[at], 2);
        ++count;
    }
    ASSERT_GT(count, 10);
    EXPECT_LT(std::sqrt(sum / count), 0.1);
    EXPECT_NEAR(drawn / real, 1, 0.02);
}

TEST_P(Coverage, PixelsWithinASurfaceShowThemselvesAlone) {
    // A wall that fills the view, and a view of nothing.
    load(wall(2, 4, 0.02f, kWhite, 2));
    draw(look({0, 0, 0}, {0.3f, 1, 0.2f}, 160, 120, 0.9f));
    for (const uint32_t word : words()) EXPECT_EQ(word, 0u);
    draw(look({0, 0, 0}, {0, -1, 0}, 160, 120, 0.9f));
    for (const uint32_t word : words()) EXPECT_EQ(word, 0u);
}

TEST_P(Coverage, SharesOfAPixelAddUpToItsSamplesAndStayInThePicture) {
    load(posts(0.03f));
    for (const uint32_t side : {1u, 2u, 17u, 100u}) {
        draw(look({0, 0, 0}, {0, 1, 0}, side, side, 0.9f));
        const auto all = words();
        for (uint32_t at = 0; at < all.size(); ++at) {
            uint32_t sum = 0;
            for (uint32_t i = 0; i < kCoverageNeighbours; ++i) {
                const uint32_t samples = all[at] >> (4 * i) & 15u;
                sum += samples;
                const glm::ivec2 there = glm::ivec2(at % side, at / side) + raster::coverage_neighbour(i);
                const bool within = there.x >= 0 && there.y >= 0 && there.x < static_cast<int>(side) &&
                                    there.y < static_cast<int>(side);
                EXPECT_TRUE(within || samples == 0);
            }
            EXPECT_LE(sum, kCoverageSamples);
        }
    }
}

TEST_P(Coverage, PointsAloneAreNotMixedWithTheBackground) {
    load(wall(3, 0.5f, 0.02f, kRed, 4));
    draw(look({0, 0, 0}, {0, 1, 0}, 120, 90, 0.9f));
    const auto points = albedo(true, true), all = albedo(true, false);
    size_t partly = 0;
    for (size_t at = 0; at < points.size(); ++at) {
        EXPECT_EQ(points[at].w, all[at].w);
        if (points[at].w <= 0 || points[at].w >= 1) continue;
        ++partly;
        EXPECT_LT(points[at].y, 0.01f) << "the background is grey";
        EXPECT_NEAR(all[at].y, 0.5f * (1 - all[at].w), 0.01f);
    }
    EXPECT_GT(partly, 50u);
}

TEST_P(Coverage, TheSameForEveryInstructionSetAndAboutAsByShaders) {
    for (const float spacing : {0.01f, 0.1f}) {
        load(posts(spacing));
        const CameraView view = look({0.1f, 0, 0}, {0, 1, 0.1f}, 211, 150, 0.9f);
        draw(view);
        const auto first = words();
        if (device->native_passes()) {
            {
                const ThreadLimit one(1);
                ASSERT_TRUE(find_coverage(*device, loaded_->cut, view, target_));
                EXPECT_EQ(words(), first);
            }
            for (int set = 0; native::use_instruction_set(set); ++set) {
                ASSERT_TRUE(find_coverage(*device, loaded_->cut, view, target_));
                EXPECT_EQ(words(), first) << set;
            }
            native::use_instruction_set(-1);
        }
        const auto shown = albedo(true);
        device->use_native_passes(false);
        ASSERT_TRUE(find_coverage(*device, loaded_->cut, view, target_));
        const auto by_shaders = words();
        const auto shown_by_shaders = albedo(true);
        device->use_native_passes(GetParam());
        size_t edges = 0, others = 0;
        for (size_t at = 0; at < first.size(); ++at) {
            edges += first[at] != 0;
            others += first[at] != by_shaders[at];
        }
        EXPECT_GT(edges, 500u);
        EXPECT_LE(others, edges / 100) << "where the last bits decide";
        EXPECT_LT(difference(shown, shown_by_shaders), 1e-3);
    }
}

INSTANTIATE_TEST_SUITE_P(Passes, Coverage, ::testing::Bool(), passes_name);

}  // namespace
}  // namespace lucarne::gi
