#include "gi/engines/volume/native/look.h"

#include <algorithm>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"

namespace lucarne::gi::volume {
namespace {

/// Adds a tree over so many faces, each of which lies somewhere in a cube of 4 m and looks somewhere.
void add_tree(std::vector<Cluster>& clusters, Random& random, uint32_t faces, const glm::vec3& middle,
              float extent) {
    const auto uniform = [&] { return static_cast<float>(random.uniform()) - 0.5f; };
    Cluster cluster{.middle = middle, .radius = extent, .faces = faces};
    cluster.low = middle - extent;
    cluster.high = middle + extent;
    cluster.normal = glm::normalize(glm::vec3(uniform(), uniform(), 0.6f)) * (faces == 1 ? 1.0f : 0.95f);
    cluster.area = 0.09f * static_cast<float>(faces);
    cluster.power = glm::vec3(1, 2, 3) * cluster.area;
    cluster.voxel = static_cast<uint32_t>(clusters.size());
    clusters.push_back(cluster);
    if (faces == 1) return;
    for (const uint32_t part : {faces / 2, faces - faces / 2})
        add_tree(clusters, random, part, middle + 0.7f * extent * glm::vec3(uniform(), uniform(), uniform()),
                 0.7f * extent);
}

TEST(Look, ReceiversTogetherSeeWhatEachSeesAlone) {
    Random random(5, 0);
    const auto uniform = [&] { return static_cast<float>(random.uniform()); };
    std::vector<Cluster> clusters;
    add_tree(clusters, random, 300, {0, 0, 0}, 2);
    ASSERT_EQ(clusters.size(), 599u);
    size_t rays_seen = 0, nearby = 0;
    for (const size_t count : {size_t{1}, size_t{5}, kReceiversTogether, kReceiversTogether - 1}) {
        std::vector<Receiver> receivers(count);
        for (Receiver& receiver : receivers)
            receiver = {1.5f * (glm::vec3(uniform(), uniform(), uniform()) - 0.5f),
                        glm::normalize(glm::vec3(uniform() - 0.5f, uniform() - 0.5f, -0.5f)), 7};
        std::vector<std::vector<Ray>> together(count), alone(1);
        look(clusters, 0, clusters.size(), receivers, 1e-4f, together);
        for (size_t i = 0; i < count; ++i) {
            alone[0].clear();
            look(clusters, 0, clusters.size(), std::span(receivers).subspan(i, 1), 1e-4f, alone);
            ASSERT_EQ(together[i].size(), alone[0].size());
            EXPECT_TRUE(std::ranges::is_sorted(alone[0], {}, &Ray::cluster));
            for (size_t k = 0; k < alone[0].size(); ++k) {
                EXPECT_EQ(together[i][k].cluster, alone[0][k].cluster);
                EXPECT_EQ(together[i][k].light, alone[0][k].light);
                nearby += alone[0][k].luminance == Ray::kNearby;
            }
            rays_seen += alone[0].size();
        }
    }
    EXPECT_GT(rays_seen, 200u);
    EXPECT_GT(nearby, 0u);
}

}  // namespace
}  // namespace lucarne::gi::volume
