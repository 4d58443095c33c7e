#include "gi/engines/paths/relight.h"

#include <cmath>

#include "gi/lighting/direct_light.h"
#include "gi/shared/brdf.h"
#include "io/core/parallel.h"
#include "tests/gi/engines/paths/paths_scenes.h"

namespace lucarne::gi::paths {
namespace {

std::vector<Material> glowing(float emission) {
    return device_materials({{glm::vec4(1, 1, 1, 0), glm::vec4(emission, emission, emission, 1)}});
}

/// A closed box of albedo .5, once for all tests.
class RelightTest : public testing::Test {
 protected:
    static void SetUpTestSuite() { bake_ = bake_of(input_of(scenes::closed_box(1, 60, glm::vec3(.5f)))); }
    static void TearDownTestSuite() { bake_.reset(); }
    static std::vector<glm::vec3> dark() { return std::vector<glm::vec3>(bake_->entries.size(), kO); }
    /// The mean irradiance of the gathering points inside the box, by their reach.
    static double inside(const std::vector<glm::vec3>& irradiance) {
        double sum = 0, weights = 0;
        for (size_t i = 0; i < irradiance.size(); ++i) {
            const GatheringPoint& point = bake_->paths.points[i];
            if (point.side % 2) continue;
            sum += irradiance[i].x * point.reach * point.reach;
            weights += point.reach * point.reach;
        }
        return sum / weights;
    }
    static std::shared_ptr<const PathsBake> bake_;
};
std::shared_ptr<const PathsBake> RelightTest::bake_;

TEST_F(RelightTest, FurnaceKeepsItsRadianceOnEveryBounce) {
    Relight relight(bake_);
    relight.enter(glowing(.5f), dark(), nullptr);
    for (const Transport transport : {Transport::links, Transport::photons})
        for (const uint32_t last : {1u, 2u, 3u, 4u}) {
            relight.enter(glowing(.5f), dark(), nullptr);
            relight.bounce({1, last}, transport);
            // Of radiance 1 - .5^(last + 1) in all, .5 is emitted; the rest is reflected irradiance.
            const double truth = kPi * (1 - std::pow(.5, last + 1) - .5) / .5;
            // Photons spread their energy as they happen to land.
            EXPECT_NEAR(inside(relight.gather()) / truth, 1, transport == Transport::links ? .002 : .02);
        }
}

TEST_F(RelightTest, PointsOutsideOfAClosedBoxGetNothing) {
    Relight relight(bake_);
    std::vector<glm::vec3> irradiance = dark();
    // Only sides within the box are lit.
    for (size_t i = 0; i < irradiance.size(); ++i)
        if (bake_->paths.entries.sides[i] % 2 == 0) irradiance[i] = glm::vec3(1e6f);
    relight.enter(glowing(0), irradiance, nullptr);
    relight.bounce({1, 4}, Transport::links);
    const auto light = relight.gather();
    size_t outside = 0;
    for (size_t i = 0; i < light.size(); ++i) {
        const bool in = bake_->paths.points[i].side % 2 == 0;
        outside += !in;
        EXPECT_EQ(light[i].x > 0, in) << i;
    }
    EXPECT_GT(outside, 50u);
}

TEST_F(RelightTest, LightOfTheFloorReachesTheCeilingByItsFormFactor) {
    Relight relight(bake_);
    std::vector<glm::vec3> irradiance = dark();
    for (size_t i = 0; i < irradiance.size(); ++i)
        if (bake_->entries[i].normal.z > .5f && bake_->entries[i].position.z < .5f)
            irradiance[i] = glm::vec3(1);
    relight.enter(glowing(0), irradiance, nullptr);
    for (const auto& [bounce, truth] : {std::pair(1u, .199825 * .5)}) {
        relight.bounce({bounce, bounce}, Transport::links);
        const auto light = relight.gather();
        double sum = 0, weights = 0;
        for (size_t i = 0; i < light.size(); ++i) {
            const GatheringPoint& point = bake_->paths.points[i];
            if (point.normal.z > -.5f || point.position.z < .5f || point.side % 2) continue;
            sum += light[i].x * point.reach * point.reach;
            weights += point.reach * point.reach;
        }
        EXPECT_NEAR(sum / weights / truth, 1, .03);
    }
}

TEST_F(RelightTest, BouncesOneByOneAddUpToAll) {
    Relight relight(bake_);
    relight.enter(glowing(.5f), dark(), nullptr);
    relight.bounce({1, 3}, Transport::links);
    const auto all = relight.gather();
    std::vector<glm::vec3> sum(all.size(), kO);
    for (const uint32_t bounce : {1u, 2u, 3u}) {
        relight.bounce({bounce, bounce}, Transport::links);
        const auto one = relight.gather();
        for (size_t i = 0; i < sum.size(); ++i) sum[i] += one[i];
    }
    for (size_t i = 0; i < sum.size(); ++i) ASSERT_NEAR(sum[i].x, all[i].x, 1e-4 * all[i].x + 1e-9);
}

TEST_F(RelightTest, IsTheSameWithOneThreadAndAfterOtherLight) {
    Relight relight(bake_);
    std::vector<glm::vec3> some = dark();
    for (size_t i = 0; i < some.size(); i += 7) some[i] = glm::vec3(1, 2, 3) * static_cast<float>(i % 13);
    for (const Transport transport : {Transport::links, Transport::photons}) {
        const auto light = [&](const std::vector<glm::vec3>& irradiance) {
            relight.enter(glowing(0), irradiance, nullptr);
            relight.bounce({1, 4}, transport);
            return relight.gather();
        };
        const auto first = light(some);
        const ThreadLimit one(1);
        EXPECT_NE(light(std::vector<glm::vec3>(some.size(), glm::vec3(1))), first);
        EXPECT_EQ(light(some), first);
    }
}

TEST_F(RelightTest, PhotonsBringWhatLinksBring) {
    Relight relight(bake_);
    std::vector<glm::vec3> some = dark();
    for (size_t i = 0; i < some.size(); ++i)
        if (bake_->entries[i].normal.x > .5f) some[i] = glm::vec3(1);
    for (const uint32_t bounce : {1u, 2u, 3u, 4u}) {
        const auto by = [&](Transport transport) {
            relight.enter(glowing(0), some, nullptr);
            relight.bounce({bounce, bounce}, transport);
            return inside(relight.gather());
        };
        EXPECT_NEAR(by(Transport::photons) / by(Transport::links), 1, .03) << bounce;
    }
    relight.enter(glowing(0), some, nullptr);
    relight.bounce({5, 5}, Transport::photons);
    EXPECT_EQ(inside(relight.gather()), 0) << "their paths have four vertices";
}

}  // namespace
}  // namespace lucarne::gi::paths
