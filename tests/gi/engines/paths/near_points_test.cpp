// Tests of many gathering points at once against that of one.
#include "gi/engines/paths/native/near_points.h"

#include <cmath>
#include <cstdint>
#include <random>
#include <set>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/raster/native/native.h"

namespace lucarne::gi::paths {
namespace {

constexpr float kFactor = 1.5f, kTurn = 0.3f;

std::vector<uint32_t> near_of(const PointCells& cells, std::span<const native::PointBlock> blocks,
                              const glm::vec3& position, const glm::vec3& normal) {
    std::vector<uint32_t> all;
    cells.visit_lists(position, [&](uint32_t first, uint32_t count) {
        const size_t begin = first / PointCells::kListed, end = (first + count - 1) / PointCells::kListed + 1;
        std::vector<uint32_t> found((end - begin) * PointCells::kListed);
        found.resize(
            native::find_near(blocks.subspan(begin, end - begin), kTurn, position, normal, found.data()));
        all.insert(all.end(), found.begin(), found.end());
    });
    return all;
}

TEST(NearPoints, PathsFindAllWithSmallErrorsAndFewOthers) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(-1, 1);
    const auto vector = [&] { return glm::vec3(uniform(random), uniform(random), uniform(random)); };
    const auto facing = [&] { return glm::normalize(glm::vec3(0, 0, 1) + 0.4f * vector()); };
    std::vector<GatheringPoint> points;
    for (int i = 0; i < 3000; ++i)
        points.push_back({{100 + 2 * uniform(random), 2 * uniform(random), 0.1f * uniform(random)},
                          (i % 2 ? 1.0f : -1.0f) * facing(),
                          0.05f + 0.3f * std::abs(uniform(random)),
                          0});
    const PointCells cells(points, kFactor);
    const auto blocks = native::point_blocks(points, cells.numbers(), kFactor);
    size_t near = 0, found = 0;
    for (int i = 0; i < 500; ++i) {
        const glm::vec3 position(100 + 2 * uniform(random), 2 * uniform(random), 0.1f * uniform(random)),
            normal = facing();
        const std::vector<uint32_t> all = near_of(cells, blocks, position, normal);
        const std::set<uint32_t> set(all.begin(), all.end());
        EXPECT_EQ(set.size(), all.size()) << "a point twice";
        for (uint32_t p = 0; p < points.size(); ++p) {
            if (!(squared_error_of(points[p], kFactor * points[p].reach, kTurn, position, normal) < 1))
                continue;
            ++near;
            ASSERT_TRUE(set.contains(p));
        }
        found += set.size();
        for (int with = 0; gi::native::use_instruction_set(with); ++with)
            ASSERT_TRUE(near_of(cells, blocks, position, normal) == all) << "set " << with;
        gi::native::use_instruction_set(-1);
    }
    EXPECT_GT(near, 500u);
    EXPECT_LE(found, near + near / 500 + 1);
}

}  // namespace
}  // namespace lucarne::gi::paths
