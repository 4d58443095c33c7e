// The codec of the shadow maps' texels, and its vectors beside the shared text.
#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/engines/vpl/shadow_maps/native/texel-inl.h"
#include "gi/engines/vpl/shadow_maps/texel.h"

namespace lucarne::gi::vpl {
namespace {

namespace vectors = native::HWY_NAMESPACE;
namespace hn = vectors::hn;

TEST(MapTexel, HoldsDistanceRadiusAndNormal) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(-1, 1);
    for (int i = 0; i < 10'000; ++i) {
        const float distance = std::exp2(15 * uniform(random)), radius = std::exp2(3 * uniform(random) - 4);
        const glm::vec3 normal =
            glm::normalize(glm::vec3(uniform(random), uniform(random), uniform(random)) + 1e-3f);
        const uint32_t texel = pack_map_texel(distance, map_surface(radius, normal));
        EXPECT_NEAR(map_distance(texel) / distance, 1, 5e-4f);
        EXPECT_NEAR(std::log2(map_radius(texel) / radius), 0, 0.501f);
        EXPECT_GT(glm::dot(map_normal(texel), normal), std::cos(0.07f)) << "4 degrees";
        EXPECT_LT(texel, pack_map_texel(1.01f * distance, 0)) << "the nearest is the smallest";
    }
    EXPECT_LT(pack_map_texel(1e9f, 0xffffu), kOpen);
}

TEST(MapTexel, OfVectorsIsTheSame) {
    const hn::ScalableTag<uint32_t> d;
    std::mt19937 random(6);
    for (int i = 0; i < 10'000; ++i) {
        const auto texel = static_cast<uint32_t>(random() >> 1);
        const auto texels = hn::Set(d, texel);
        const auto distances = vectors::map_distances(d, texels);
        EXPECT_EQ(hn::GetLane(distances), map_distance(texel));
        EXPECT_EQ(hn::GetLane(vectors::map_radii(d, texels)), map_radius(texel));
        const auto surfaces = hn::Set(d, texel & 0xffffu);
        const auto packed = vectors::pack_map_texels(d, vectors::distances_within(d, distances), surfaces);
        EXPECT_EQ(hn::GetLane(packed), pack_map_texel(map_distance(texel), texel & 0xffffu));
    }
}

}  // namespace
}  // namespace lucarne::gi::vpl
