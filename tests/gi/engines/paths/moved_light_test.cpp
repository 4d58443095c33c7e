// Tests of many rays at once against one after the other.
#include "gi/engines/paths/native/moved_light.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/raster/native/native.h"

namespace lucarne::gi::paths::native {
namespace {

/// The sums of rays as the formula says, with more digits.
struct PlainSums {
    double light = 0, times = 0;
};
PlainSums add_plainly(const std::vector<RayBlock>& blocks, const glm::vec3& place, const glm::vec3& normal,
                      float radius2) {
    PlainSums sums;
    for (const RayBlock& block : blocks)
        for (size_t i = 0; i < RayBlock::kRays; ++i) {
            const glm::dvec3 away = glm::dvec3(block.x[i], block.y[i], block.z[i]) - glm::dvec3(place);
            const glm::dvec3 facing(block.normal_x[i], block.normal_y[i], block.normal_z[i]);
            const double distance2 = glm::dot(away, away);
            const double cosines =
                std::max(glm::dot(away, glm::dvec3(normal)), 0.0) * std::max(-glm::dot(away, facing), 0.0);
            const double distance4 = std::max(distance2 * (distance2 + radius2), 1e-12);
            const double times = std::min(block.weight[i] * cosines / distance4, double{kMostTimes});
            sums.light += times * block.light[i];
            sums.times += times;
        }
    return sums;
}

TEST(MovedLight, PathsAddRaysAsOneAfterTheOtherWithEveryInstructionSet) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(-1, 1);
    const auto vector = [&] { return glm::vec3(uniform(random), uniform(random), uniform(random)); };
    std::vector<RayBlock> blocks(31);
    for (RayBlock& block : blocks)
        for (size_t i = 0; i < RayBlock::kRays; ++i) {
            const glm::vec3 place = 4.0f * vector(), normal = glm::normalize(vector());
            block.x[i] = place.x, block.y[i] = place.y, block.z[i] = place.z;
            block.normal_x[i] = normal.x, block.normal_y[i] = normal.y, block.normal_z[i] = normal.z;
            block.weight[i] = 10 * std::abs(uniform(random));
            block.light[i] = std::abs(uniform(random));
        }
    for (size_t i = 3; i < RayBlock::kRays; ++i) {  // of a number that is no multiple of the lanes
        blocks.back().weight[i] = 0;
        blocks.back().light[i] = 0;
    }
    size_t lit = 0;
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 normal = glm::normalize(vector());
        glm::vec3 place = vector();
        if (i == 0) place = {blocks[7].x[2], blocks[7].y[2], blocks[7].z[2]};  // where a ray ended
        const RaySums sums = add_moved(blocks, place, normal, .01f);
        const PlainSums plain = add_plainly(blocks, place, normal, .01f);
        EXPECT_NEAR(sums.times, plain.times, 1e-5 * plain.times);
        EXPECT_NEAR(sums.light, plain.light, 1e-5 * plain.light);
        lit += plain.light > 0;
        for (int with = 0; gi::native::use_instruction_set(with); ++with) {
            const RaySums again = add_moved(blocks, place, normal, .01f);
            ASSERT_TRUE(again.light == sums.light && again.times == sums.times) << "set " << with;
        }
        gi::native::use_instruction_set(-1);
    }
    EXPECT_GT(lit, 190u);
    const RaySums none = add_moved({}, glm::vec3(0.0f), glm::vec3(0, 0, 1), .01f);
    EXPECT_EQ(none.light, 0);
    EXPECT_EQ(none.times, 0);
}

}  // namespace
}  // namespace lucarne::gi::paths::native
