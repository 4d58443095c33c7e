#include "viewer/camera/glide.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace lucarne::viewer {
namespace {

gi::SceneCamera camera(const glm::dvec3& position, const glm::dvec3& ahead, double fov = 1) {
    gi::SceneCamera made;
    made.position = position;
    made.target = position + ahead;
    made.vertical_fov = fov;
    return made;
}

TEST(CameraGlide, EndsExactlyWhereItWasSentWhateverTheSteps) {
    const auto from = camera({0, 0, 0}, {0, 5, 0}), to = camera({10, 20, 3}, {-3, .1, -1}, .7);
    for (const double step : {.001, .1, .35, 5.0}) {
        CameraGlide glide;
        EXPECT_FALSE(glide.advance(step)) << "it has not begun";
        glide.start(from, to);
        gi::SceneCamera last = from;
        while (const auto next = glide.advance(step)) last = *next;
        EXPECT_EQ(last.position, to.position);
        EXPECT_EQ(last.target, to.target);
        EXPECT_EQ(last.vertical_fov, to.vertical_fov);
        EXPECT_FALSE(glide.under_way());
    }
}

TEST(CameraGlide, TurnsTheShortWayAndNeverJumps) {
    // From a little right of -x to a little left of it: the short way passes -x.
    const auto from = camera({0, 0, 0}, {-1, .1, 0}), to = camera({1, 0, 0}, {-1, -.1, 0});
    CameraGlide glide;
    glide.start(from, to);
    gi::SceneCamera before = from;
    for (int i = 0; i < 69; ++i) {
        const auto now = glide.advance(CameraGlide::kSeconds / 70);
        ASSERT_TRUE(now);
        const glm::dvec3 ahead = glm::normalize(now->target - now->position);
        EXPECT_LT(ahead.x, -.99);
        EXPECT_GE(now->position.x, before.position.x);
        EXPECT_LT(now->position.x - before.position.x, 1.6 / 70) << "at most one and a half times the mean";
        before = *now;
    }
}

TEST(GoneToward, KeepsHeightAndDirectionAndStopsBeforeThePoint) {
    const auto from = camera({1, 2, 1.6}, {0, 3, -.5});
    const auto gone = gone_toward(from, {1, 12, 0}, 1.2);
    EXPECT_LT(glm::distance(gone.position, {1, 12 - 1.2, 1.6}), 1e-12);
    EXPECT_LT(glm::distance(gone.target - gone.position, from.target - from.position), 1e-12);
    EXPECT_LT(glm::distance(gone_toward(from, {2, 2, 9}, 1.2).position, {1.5, 2, 1.6}), 1e-12) << "half way";
    EXPECT_EQ(gone_toward(from, {1, 2, 0}, 1.2).position, from.position) << "the floor under the camera";
}

TEST(CameraGlide, OfParallelCamerasIsAJump) {
    auto to = camera({1, 0, 0}, {0, 1, 0});
    to.orthographic_height = 3;
    CameraGlide glide;
    glide.start(camera({0, 0, 0}, {0, 1, 0}), to);
    const auto there = glide.advance(0);
    ASSERT_TRUE(there);
    EXPECT_EQ(there->position, to.position);
    EXPECT_EQ(there->orthographic_height, 3);
}

}  // namespace
}  // namespace lucarne::viewer
