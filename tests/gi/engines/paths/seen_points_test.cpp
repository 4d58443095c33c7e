#include "gi/engines/paths/seen_points.h"

#include "tests/gi/engines/paths/paths_scenes.h"

namespace lucarne::gi::paths {
namespace {

/// A floor with a screen across it, and points on it on both sides of the screen: x = -.3, -.1, .1, .3.
class PointsAboutAScreen : public testing::Test {
 protected:
    PointsAboutAScreen() {
        for (const float x : {-.3f, -.1f, .1f, .3f})
            bake_.paths.points.push_back(
                {.position = {x, .5f, 0}, .normal = kZ, .reach = .2f, .radius = .01f, .side = 0});
        bake_.far = PointCells(bake_.paths.points, kFarReach);
    }
    static std::vector<Surfel> surfels() {
        std::vector<Surfel> surfels;
        scenes::add_rectangle(surfels, {-1, 0, 0}, 2.0f * kX, 2.0f * kY, 60, glm::vec3(.5f));
        scenes::add_rectangle(surfels, {0, 0, .005f}, 2.0f * kY, 2.0f * kZ, 60, glm::vec3(.5f));
        return surfels;
    }
    /// Returns the points that a place on the floor sees of these, with these irradiances of all.
    std::vector<PointShare> seen_from(float x, const std::vector<PointShare>& about,
                                      const std::vector<glm::vec3>& irradiance) const {
        const SeenPoints points(*tracer_, bake_, kO, irradiance);
        const SurfacePoint place{{x, .5f, 0}, kZ,   glm::normalize(glm::vec3(x > 0 ? 1 : -1, 0, 1)),
                                 {},          .01f, 0};
        std::vector<PointShare> seen;
        const auto result = points.about(place, start_of_rays(*tracer_, place), about, seen);
        return {result.begin(), result.end()};
    }

    std::unique_ptr<tracing::SurfelTracer> tracer_ = tracer_of(surfels());
    PathsBake bake_;
    const std::vector<glm::vec3> even_{glm::vec3(1), glm::vec3(1), glm::vec3(1), glm::vec3(1)};
    const std::vector<glm::vec3> uneven_{glm::vec3(1), glm::vec3(2), glm::vec3(20), glm::vec3(30)};
};

TEST_F(PointsAboutAScreen, CountOnTheirSideOfIt) {
    const auto seen = seen_from(-.05f, {{1, .5f}, {0, .25f}, {2, .25f}}, uneven_);
    ASSERT_EQ(seen.size(), 2u);
    EXPECT_EQ(seen[0].point, 1u);
    EXPECT_EQ(seen[1].point, 0u);
    EXPECT_NEAR(seen[0].share, 2.0 / 3, 1e-6) << "shares add up to 1";
    EXPECT_NEAR(seen[1].share, 1.0 / 3, 1e-6);
}

TEST_F(PointsAboutAScreen, AreNotTestedWhereTheyHaveTheSameLight) {
    EXPECT_EQ(seen_from(-.05f, {{1, .5f}, {2, .5f}}, even_).size(), 2u);
}

TEST_F(PointsAboutAScreen, AreReplacedByTheNearestWhereNoneIsSeen) {
    const auto seen = seen_from(-.05f, {{2, .5f}, {3, .5f}}, uneven_);
    ASSERT_EQ(seen.size(), 1u);
    EXPECT_EQ(seen[0].point, 1u);
    EXPECT_EQ(seen[0].share, 1.0f);
    ASSERT_EQ(seen_from(.05f, {{0, 1.0f}}, uneven_).size(), 1u);
    EXPECT_EQ(seen_from(.05f, {{0, 1.0f}}, uneven_)[0].point, 2u);
}

TEST_F(PointsAboutAScreen, AreAskedForBeforeWhatHidesARim) {
    for (const float viewer : {-1.0f, 1.0f}) {
        const SurfacePoint rim{{-.005f, .5f, 0}, kZ, glm::normalize(glm::vec3(viewer, 0, 1)), {}, .01f, 0};
        EXPECT_GT(start_of_rays(*tracer_, rim).x * viewer, 0) << "on the side from which it is seen";
    }
}

}  // namespace
}  // namespace lucarne::gi::paths
