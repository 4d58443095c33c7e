#include "gi/scene/views.h"

#include <cmath>
#include <set>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace lucarne::gi {
namespace {

SceneCamera camera(const glm::dvec3& position, const glm::dvec3& target) {
    SceneCamera c;
    c.position = position;
    c.target = target;
    c.vertical_fov = 1.0;
    return c;
}

/// Returns the ray of gi/shared/camera.h through a pixel's centre.
glm::vec3 ray(const CameraView& v, float x, float y) {
    const auto part = [](const glm::vec4& a) { return glm::vec3(a.x, a.y, a.z); };
    return part(v.forward) + part(v.right) * (2 * (x + .5f) / static_cast<float>(v.width) - 1) -
           part(v.up) * (2 * (y + .5f) / static_cast<float>(v.height) - 1);
}

TEST(Views, CameraLooksAtItsTargetWithUpOnTopAndRightOnTheRight) {
    const auto view = camera_view(camera({1, 2, 3}, {1, 12, 3}), {200, 100}, {{0, 0, 0}, 1.0});
    EXPECT_NEAR(glm::distance(ray(view, 99.5f, 49.5f), glm::vec3(0, 1, 0)), 0, 1e-6);
    EXPECT_GT(ray(view, 199, 49.5f).x, 0);
    EXPECT_GT(ray(view, 99.5f, 0).z, 0);
    EXPECT_NEAR(ray(view, 99.5f, -.5f).z, std::tan(0.5), 1e-6);        // the upper edge
    EXPECT_NEAR(ray(view, 199.5f, 49.5f).x, 2 * std::tan(0.5), 1e-6);  // twice as wide as high
}

TEST(Views, LookingStraightUpOrAtOneselfStillGivesAFrame) {
    for (const auto& target : {glm::dvec3(0, 0, 5), glm::dvec3(0, 0, -5), glm::dvec3(0, 0, 0)}) {
        const auto view = octree_view(camera({0, 0, 0}, target), ImageSize{10, 10});
        for (const auto& axis : {view.forward, view.right, view.up}) EXPECT_NEAR(glm::length(axis), 1, 1e-9);
        EXPECT_NEAR(glm::dot(glm::cross(view.right, view.forward), view.up), 1, 1e-9);
    }
}

TEST(Views, LocalFrameKeepsProjectedCoordinatesExactInFloats) {
    const glm::dvec3 utm(512345.678, 5403210.123, 171.25);
    for (const double unit : {1.0, 0.3048}) {
        const LocalFrame frame = local_frame(utm, unit);
        const glm::dvec3 back = glm::dvec3(frame.to_local(utm)) / unit + frame.origin;
        EXPECT_LT(glm::distance(back, utm) * unit, 2e-5);
        EXPECT_EQ(local_frame(utm + glm::dvec3(0.01), unit).origin, frame.origin);
    }
}

TEST(Views, SpotKeepsItsConeAndFadesOverItsSoftness) {
    SceneLight spot;
    spot.position = {0, 0, 4};
    spot.target = {0, 0, 0};
    spot.angle = 1.0;
    spot.softness = 0.2;
    const auto light = device_light(spot, {{0, 0, 0}, 1.0});
    EXPECT_FLOAT_EQ(light.position.w, std::cos(0.5f));
    EXPECT_FLOAT_EQ(light.direction.w, std::cos(0.4f));
    EXPECT_FLOAT_EQ(light.direction.z, -1);
}

TEST(Views, LightsComeInMetresWhateverTheUnitOfTheScan) {
    const LocalFrame feet{{10, 0, 0}, 0.3048};
    SceneLight lamp;
    lamp.kind = LightKind::rectangle;
    lamp.position = {20, 0, 10};
    lamp.target = {20, 0, 0};
    lamp.up = {0, 1, 0};
    lamp.width = 4;
    lamp.height = 2;
    const auto light = device_light(lamp, feet);
    EXPECT_EQ(light.kind, kRectangleLight);
    EXPECT_NEAR(light.position.x, 3.048f, 1e-6f);
    EXPECT_FLOAT_EQ(light.direction.z, -1);
    EXPECT_NEAR(std::abs(light.extent.x), 2 * .3048f, 1e-6f);  // half the width, across `up`
    EXPECT_NEAR(light.extent.y, 0, 1e-6f);
    EXPECT_NEAR(light.extent.w, .3048f, 1e-6f);
    lamp.kind = LightKind::disc;
    lamp.radius = 1;
    EXPECT_NEAR(device_light(lamp, feet).extent.w, .3048f, 1e-6f);
    lamp.kind = LightKind::directional;
    lamp.angular_radius = 0.01;
    EXPECT_FLOAT_EQ(device_light(lamp, feet).direction.w, 0.01f);
}

}  // namespace
}  // namespace lucarne::gi
