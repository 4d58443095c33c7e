#include "gi/engines/paths/moved_rays.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/engines/paths/interpolation.h"
#include "gi/engines/paths/seen_points.h"
#include "gi/shared/brdf.h"
#include "tests/gi/engines/paths/paths_scenes.h"

namespace lucarne::gi::paths {
namespace {

/// A room with a patch of light on its floor, beside a wall.
class MovedRaysInARoom : public testing::Test {
 protected:
    static bool is_lit(const glm::vec3& place) {
        return place.z < .05f && place.x < .3f && std::abs(place.y - .5f) < .15f;
    }
    std::vector<glm::vec3> patch() const {
        std::vector<glm::vec3> light(bake_->paths.groups.count(), glm::vec3(0.0f));
        for (size_t i = 0; i < light.size(); ++i)
            if (is_lit(bake_->planes[i].centre) && bake_->planes[i].normal.z > .9f)
                light[i] = glm::vec3(1.0f);
        return light;
    }
    /// Irradiance by the patch: nothing is in between.
    double truth(const Surfel& at) const {
        double sum = 0;
        for (const Surfel& s : surfels_) {
            if (!is_lit(s.position) || s.normal.z < .9f) continue;
            const glm::vec3 away = s.position - at.position;
            const float distance2 = glm::dot(away, away);
            sum += std::max(glm::dot(away, at.normal), 0.0f) * std::max(-away.z, 0.0f) * s.area /
                   (kPi * distance2 * distance2);
        }
        return sum;
    }
    static float factor(const MovedRays& moved, const Surfel& s, std::span<const PointShare> about) {
        return moved.factor(tracing::offset_origin(s.position, s.normal, 1e-3f), s.normal, about);
    }
    const std::vector<Surfel> surfels_ = scenes::closed_box(1, 60, glm::vec3(.5f));
    const std::shared_ptr<const PathsBake> bake_ = bake_of(input_of(surfels_, 200, 1024));
};

TEST_F(MovedRaysInARoom, KeepEvenLight) {
    MovedRays moved(bake_);
    moved.set(std::vector<glm::vec3>(bake_->paths.groups.count(), glm::vec3(2.0f)));
    PointFinder finder(*bake_);
    for (const Surfel& s : scenes::closed_box(1, 9, glm::vec3(.5f))) {
        finder.find(s.position, s.normal);
        EXPECT_NEAR(factor(moved, s, finder.shares()), 1, 1e-4);
    }
    EXPECT_EQ(factor(moved, surfels_[0], {}), 1);
    moved.set(std::vector<glm::vec3>(bake_->paths.groups.count(), glm::vec3(0.0f)));
    EXPECT_EQ(factor(moved, surfels_[0], finder.shares()), 1) << "in the dark";
}

// Points alone are off by .45 of the light in the mean, and with moved rays by .14.
TEST_F(MovedRaysInARoom, BringThePatchNearerToWhatItGives) {
    MovedRays moved(bake_);
    const std::vector<glm::vec3> light = patch();
    moved.set(light);
    const LightPaths& paths = bake_->paths;
    std::vector<glm::vec3> irradiance(paths.points.size(), glm::vec3(0.0f));
    for (size_t i = 0; i < paths.rays.size(); ++i)
        if (paths.rays[i] != kNone)
            irradiance[i / paths.rays_a_point] += light[paths.rays[i]] / float(paths.rays_a_point);
    PointFinder finder(*bake_);
    double sum = 0, off = 0, off_before = 0;
    for (const Surfel& s : surfels_) {
        // The wall beside the patch, and its foot apart: there it is finer than the rays.
        if (s.normal.x < .9f || std::abs(s.position.y - .5f) > .3f || s.position.z < .08f) continue;
        ASSERT_TRUE(finder.find(s.position, s.normal));
        const double mean = irradiance_of(finder.shares(), irradiance).x, exact = truth(s);
        sum += exact;
        off_before += std::abs(mean - exact);
        off += std::abs(mean * factor(moved, s, finder.shares()) - exact);
    }
    ASSERT_GT(sum, 0);
    EXPECT_LT(off, .4 * off_before) << off / sum << " " << off_before / sum;
}

// From behind the wall, where the place itself is, the rays would go through the wall, and the patch beside
// it would be on the other side of the plane.
TEST_F(MovedRaysInARoom, OfTheRimOfADiscBehindAWallStartBeforeTheWall) {
    MovedRays moved(bake_);
    const std::vector<glm::vec3> light = patch();
    moved.set(light);
    const auto tracer = tracer_of(surfels_);
    PointFinder finder(*bake_);
    double before = 0, behind = 0, places = 0;
    for (float z = .1f; z < .6f; z += .05f) {
        // The wall at y = 0 ends at that at x = 0, and its discs stick out through that one by up to 1 mm.
        const SurfacePoint rim{.position = {-.001f, 0, z},
                               .normal = kY,
                               .viewer = glm::normalize(glm::vec3(1, 1, 0)),
                               .radius = .009f};
        ASSERT_TRUE(finder.find(rim.position, rim.normal));
        const glm::vec3 start = start_of_rays(*tracer, rim),
                        above = tracing::offset_origin(rim.position, rim.normal, rim.radius);
        EXPECT_GT(start.x, 0) << "in the room";
        EXPECT_LT(glm::distance(start, rim.position), 3 * rim.radius);
        ++places;
        const Surfel inside{.position = {.01f, 0, z}, .normal = kY};
        const double exact = factor(moved, inside, finder.shares());
        before += std::abs(moved.factor(start, rim.normal, finder.shares()) / exact - 1);
        behind += std::abs(moved.factor(above, rim.normal, finder.shares()) / exact - 1);
    }
    EXPECT_LT(before, .5 * behind) << before << " " << behind;
    EXPECT_LT(before, .1 * places) << "the light of a place 1 cm beside the wall";
}

// Of a wall in whose plane a place lies rays bring nothing: in the corner they brought .05 of the light of a
// wall that alone is lit. Now it is .38; what is nearer to the wall than rays are to each other is missing.
TEST_F(MovedRaysInARoom, InTheCornerOfTwoWallsBringTheLightOfBoth) {
    std::vector<glm::vec3> light(bake_->paths.groups.count(), glm::vec3(0.0f));
    for (size_t i = 0; i < light.size(); ++i)
        if (bake_->planes[i].normal.x > .9f) light[i] = glm::vec3(1.0f);
    MovedRays moved(bake_);
    moved.set(light);
    const LightPaths& paths = bake_->paths;
    std::vector<glm::vec3> irradiance(paths.points.size(), glm::vec3(0.0f));
    for (size_t i = 0; i < paths.rays.size(); ++i)
        if (paths.rays[i] != kNone)
            irradiance[i / paths.rays_a_point] += light[paths.rays[i]] / float(paths.rays_a_point);
    PointFinder finder(*bake_);
    double sum = 0, places = 0;
    for (const float x : {0.0f, .0005f, .001f})
        for (float y = .2f; y < .8f; y += .05f) {
            const Surfel floor{.position = {x, y, 0}, .normal = kZ};
            ASSERT_TRUE(finder.find(floor.position, floor.normal));
            sum += irradiance_of(finder.shares(), irradiance).x * factor(moved, floor, finder.shares());
            ++places;
        }
    // It sees half of its hemisphere as the wall, but for what is beside and above that.
    double exact = 0;
    for (const Surfel& s : surfels_) {
        if (s.normal.x < .9f) continue;
        const glm::vec3 away = s.position - glm::vec3(.02f, .5f, 0);
        const float distance2 = glm::dot(away, away);
        exact += away.z * std::max(-glm::dot(away, s.normal), 0.0f) * s.area / (kPi * distance2 * distance2);
    }
    EXPECT_GT(sum / places, .3 * exact);
    EXPECT_LT(sum / places, 1.1 * exact);
}

}  // namespace
}  // namespace lucarne::gi::paths
