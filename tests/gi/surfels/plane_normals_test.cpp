#include "gi/surfels/plane_normals.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "gi/shared/surfel_code.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace {

FlatSurfel bare(const glm::vec3& at, float radius) {
    return {.x = at.x,
            .y = at.y,
            .z = at.z,
            .radius = radius,
            .area = 1e-4f,
            .normal = 0,
            .albedo = 0x3fffffffu,
            .material = 0,
            .edge_root = 0};
}

TEST(PlaneNormals, AreThoseOfTheWallsOfARoom) {
    // Points by chance, 2 cm apart, of walls with a noise of 2 mm.
    Random random(3, 0);
    const auto uniform = [&] { return static_cast<float>(random.uniform()); };
    std::vector<FlatSurfel> surfels;
    for (int i = 0; i < 60000; ++i) {
        glm::vec3 at(2 * uniform(), 2 * uniform(), 2 * uniform());
        at[i % 3] = (i / 3 % 2 ? 2.0f : 0.0f) + 0.004f * (uniform() - 0.5f);
        surfels.push_back(bare(at, 0.03f));
    }
    const std::vector<FlatSurfel> before = surfels;
    ASSERT_TRUE(add_plane_normals(surfels));
    size_t right = 0;
    for (size_t i = 0; i < surfels.size(); ++i) {
        ASSERT_TRUE(surfels[i].albedo & kSurfelHasNormal);
        EXPECT_EQ(surfels[i].albedo & ~kSurfelHasNormal, before[i].albedo);
        right += std::abs(decode_octahedral(surfels[i].normal)[static_cast<int>(i % 3)]) > 0.97f;
    }
    EXPECT_GT(right, surfels.size() * 4 / 5) << "all but those within 6 cm of the edges of the room";
}

TEST(PlaneNormals, KnownNormalsAndWhatHasNoDiscStay) {
    std::vector<FlatSurfel> surfels = {bare({0, 0, 0}, 0.1f), bare({1, 0, 0}, 0.0f), bare({2, 0, 0}, 0.1f)};
    surfels[0].albedo |= kSurfelHasNormal;
    surfels[0].normal = encode_octahedral({0, 1, 0});
    surfels[2].x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(add_plane_normals(surfels));
    EXPECT_EQ(surfels[0].normal, encode_octahedral({0, 1, 0}));
    EXPECT_FALSE(surfels[1].albedo & kSurfelHasNormal);
    EXPECT_FALSE(surfels[2].albedo & kSurfelHasNormal);
    EXPECT_FALSE(add_plane_normals({}));
}

TEST(PlaneNormals, AFewPointsWithoutOneLieOnNoSurface) {
    std::vector<FlatSurfel> surfels;
    for (int i = 0; i < 100; ++i) {
        surfels.push_back(bare({0.01f * static_cast<float>(i), 0, 0}, 0.1f));
        if (i % 50 != 0) surfels.back().albedo |= kSurfelHasNormal;
    }
    EXPECT_FALSE(add_plane_normals(surfels));
    for (FlatSurfel& s : surfels) s.albedo &= ~kSurfelHasNormal;
    EXPECT_TRUE(add_plane_normals(surfels));
}

TEST(PlaneNormals, OfClumpsAndDistantPointsAreUnitVectors) {
    std::vector<FlatSurfel> surfels(50000, bare({5, 5, 5}, 0.1f));
    for (int i = 0; i < 100; ++i) surfels.push_back(bare({1e7f, static_cast<float>(i), 0}, 0.1f));
    surfels.push_back(bare({-3e38f, 3e38f, 0}, 1e30f));
    ASSERT_TRUE(add_plane_normals(surfels));
    for (const FlatSurfel& s : surfels)
        ASSERT_NEAR(glm::length(decode_octahedral(s.normal)), 1, 1e-5) << s.x << " " << s.y;
}

}  // namespace
}  // namespace lucarne::gi
