#include "viewer/camera/navigation.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace lucarne::viewer {
namespace {

CameraRig rig_at(const glm::dvec3& position, const glm::dvec3& target) {
    gi::SceneCamera camera;
    camera.position = position;
    camera.target = target;
    return CameraRig(camera);
}

/// Returns the place of a world point in the picture, as tangents to the right and up.
glm::dvec2 seen(const CameraRig& rig, const glm::dvec3& point) {
    const glm::dvec3 offset = point - rig.position();
    const double depth = glm::dot(offset, rig.forward());
    return {glm::dot(offset, rig.right()) / depth, glm::dot(offset, rig.up()) / depth};
}

TEST(CameraRig, LooksAtTheTargetItWasMadeWith) {
    const CameraRig rig = rig_at({1, 2, 3}, {-4, 8, 1});
    EXPECT_LT(glm::distance(rig.forward(), glm::normalize(glm::dvec3(-5, 6, -2))), 1e-12);
    EXPECT_LT(glm::distance(rig.camera().target, {-4, 8, 1}), 1e-9);
    EXPECT_NEAR(glm::dot(rig.right(), rig.up()), 0, 1e-12);
    EXPECT_EQ(rig.right().z, 0) << "the horizon is level";
}

TEST(Navigation, DragsInARoomLookAroundAndDoNotMoveTheCamera) {
    for (const auto mode : {NavigationMode::orbit, NavigationMode::turntable}) {
        CameraRig rig = rig_at({0, 0, 0}, {0, 4, 0});
        Navigation navigation(10);
        navigation.set_mode(mode);
        EXPECT_TRUE(navigation.apply({.drag = {0.1, 0.05}, .rotate = true, .inside = true}, rig));
        EXPECT_EQ(rig.position() == glm::dvec3(0), mode == NavigationMode::orbit);
        EXPECT_LT(rig.forward().y, .99);
    }
}

TEST(CameraRig, OrbitingLeavesThePivotWhereItIsInThePicture) {
    CameraRig rig = rig_at({10, 0, 5}, {0, 0, 0});
    rig.set_pivot({1, 2, -1});  // beside the middle
    const glm::dvec2 before = seen(rig, rig.pivot());
    const double distance = glm::distance(rig.position(), rig.pivot());
    for (int i = 0; i < 20; ++i) {
        rig.orbit(0.3, i < 10 ? 0.2 : -0.35);
        EXPECT_LT(glm::distance(seen(rig, rig.pivot()), before), 1e-9);
        EXPECT_NEAR(glm::distance(rig.position(), rig.pivot()), distance, 1e-9);
        EXPECT_GT(rig.up().z, 0) << "never upside down";
    }
}

TEST(CameraRig, PanningMovesThePivotsSurroundingsWithThePointer) {
    CameraRig rig = rig_at({10, 0, 5}, {0, 0, 0});
    const glm::dvec3 point = rig.pivot();
    const glm::dvec2 before = seen(rig, point);
    rig.pan({0.1, 0.2});
    const double height = 2 * std::tan(rig.camera().vertical_fov / 2);  // of the picture, as tangents
    EXPECT_NEAR(seen(rig, point).x - before.x, 0.1 * height, 1e-9);
    EXPECT_NEAR(seen(rig, point).y - before.y, 0.2 * height, 1e-9);
}

TEST(CameraRig, ZoomingKeepsThePointInPlaceAndNeverPassesIt) {
    CameraRig rig = rig_at({10, 0, 5}, {0, 0, 0});
    const glm::dvec3 point(1, 3, 0);
    const glm::dvec2 before = seen(rig, point);
    for (int i = 0; i < 50; ++i) rig.zoom(0.85, point);
    EXPECT_LT(glm::distance(seen(rig, point), before), 1e-6);
    EXPECT_GT(glm::dot(point - rig.position(), rig.forward()), 0);
}

TEST(CameraRig, RaysGoThroughThePicture) {
    CameraRig rig = rig_at({10, 0, 5}, {0, 0, 0});
    const CameraRig::Ray ray = rig.ray({0.5, -0.25}, 1.5);
    EXPECT_EQ(ray.from, rig.position());
    EXPECT_NEAR(glm::dot(ray.along, rig.forward()), 1, 1e-12);
    const glm::dvec2 place = seen(rig, rig.position() + 7.0 * ray.along);
    const double tangent = std::tan(rig.camera().vertical_fov / 2);
    EXPECT_NEAR(place.x, 0.5 * 1.5 * tangent, 1e-12);
    EXPECT_NEAR(place.y, -0.25 * tangent, 1e-12);

    rig.set_orthographic(true);
    const CameraRig::Ray parallel = rig.ray({0.5, -0.25}, 1.5);
    EXPECT_EQ(parallel.along, rig.forward());
    const double half = rig.camera().orthographic_height / 2;
    const glm::dvec3 aside = parallel.from - rig.position();
    EXPECT_NEAR(glm::dot(aside, rig.right()), 0.5 * 1.5 * half, 1e-9);
    EXPECT_NEAR(glm::dot(aside, rig.up()), -0.25 * half, 1e-9);
    EXPECT_NEAR(glm::dot(aside, rig.forward()), 0, 1e-9);
}

TEST(Navigation, OrbitDragsTurnScrollGoesNearerAndKeysDoNothing) {
    Navigation navigation(20);
    CameraRig rig = rig_at({10, 0, 5}, {0, 0, 0});
    EXPECT_FALSE(navigation.apply({.keys = {1, 0, 1}, .seconds = 0.1}, rig));
    EXPECT_FALSE(navigation.apply({.drag = {0.1, 0.1}}, rig)) << "no button";
    const double distance = glm::distance(rig.position(), rig.pivot());
    EXPECT_TRUE(navigation.apply({.drag = {0.1, 0.05}, .rotate = true}, rig));
    EXPECT_NEAR(glm::distance(rig.position(), rig.pivot()), distance, 1e-9);
    EXPECT_TRUE(navigation.apply({.scroll = 2}, rig));
    EXPECT_LT(glm::distance(rig.position(), rig.pivot()), distance * 0.8);
    EXPECT_TRUE(navigation.apply({.drag = {0.1, 0.0}, .shift = true}, rig));
    EXPECT_EQ(glm::dvec3(rig.camera().up), glm::dvec3(0, 0, 1));
}

TEST(Navigation, FlyingMovesWithTheKeysAndScrollSetsTheSpeed) {
    Navigation navigation(20);
    navigation.set_mode(NavigationMode::fly);
    CameraRig rig = rig_at({10, 0, 5}, {0, 0, 5});
    EXPECT_TRUE(navigation.apply({.keys = {0, 0, 1}, .seconds = 0.1}, rig));
    EXPECT_NEAR(rig.position().x, 10 - 0.1 * navigation.speed(), 1e-12);
    const double slow = navigation.speed();
    EXPECT_FALSE(navigation.apply({.scroll = 3}, rig));
    EXPECT_GT(navigation.speed(), slow);
    const glm::dvec3 before = rig.position();
    EXPECT_TRUE(navigation.apply({.drag = {0.2, 0.1}, .rotate = true}, rig));
    EXPECT_EQ(rig.position(), before) << "looking around stays in place";
    EXPECT_TRUE(navigation.apply({.keys = {0, 0, 1}, .seconds = 60}, rig));
    EXPECT_LE(glm::distance(rig.position(), before), navigation.speed() * 0.25 + 1e-9)
        << "a stalled frame is no leap";
}

TEST(CameraRig, AnOrthographicViewKeepsWhatLiesAtThePivotAsLargeAsItWas) {
    CameraRig rig = rig_at({10, 0, 5}, {0, 0, 0});
    const gi::SceneCamera before = rig.camera();
    rig.set_orthographic(true);
    const gi::SceneCamera parallel = rig.camera();
    EXPECT_NEAR(parallel.orthographic_height,
                2 * std::tan(before.vertical_fov / 2) * glm::distance(before.position, before.target), 1e-9);
    rig.set_orthographic(false);
    EXPECT_LT(glm::distance(rig.position(), before.position), 1e-9);
    EXPECT_EQ(rig.camera().orthographic_height, 0);
}

TEST(CameraRig, OrthographicZoomKeepsThePointInPlaceAndStandsClearOfTheScene) {
    CameraRig rig = rig_at({10, 0, 0}, {0, 0, 0});
    rig.set_orthographic(true);
    rig.set_clearance(50);
    const glm::dvec3 point(1, 2, 1);
    const auto place = [&] {
        const glm::dvec3 offset = point - rig.camera().position;
        return glm::dvec2(glm::dot(offset, rig.right()), glm::dot(offset, rig.up())) /
               rig.camera().orthographic_height;
    };
    const glm::dvec2 before = place();
    const double height = rig.camera().orthographic_height;
    rig.zoom(0.25, point);
    EXPECT_NEAR(rig.camera().orthographic_height, height / 4, 1e-12);
    EXPECT_LT(glm::distance(place(), before), 1e-9);
    EXPECT_NEAR(glm::dot(point - rig.camera().position, rig.forward()), 50, 1e-9);
    const CameraRig again(rig.camera());
    EXPECT_LT(glm::distance(again.camera().position, rig.camera().position), 1e-9)
        << "a bookmark stays where it was set";
}

TEST(CameraRig, LooksFromTheSidesAndFitsAllIn) {
    CameraRig rig = rig_at({10, 0, 5}, {0, 0, 0});
    const std::array<glm::dvec3, 2> box = {glm::dvec3(-1, -2, -3), glm::dvec3(3, 2, 1)};
    rig.look_along(M_PI / 2, -M_PI / 2);
    rig.fit(box, {1, {}});
    EXPECT_LT(glm::distance(rig.forward(), {0, 0, -1}), 1e-4) << "from above";
    EXPECT_LT(glm::distance(rig.up(), {0, 1, 0}), 1e-4) << "north is up";
    EXPECT_LT(glm::distance(rig.pivot(), {1, 0, -1}), 1e-12);
    const double tangent = std::tan(rig.camera().vertical_fov / 2);
    double farthest = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p(box[corner & 1].x, box[corner >> 1 & 1].y, box[corner >> 2].z);
        const auto place = seen(rig, p);
        farthest = std::max({farthest, std::abs(place.x), std::abs(place.y)});
    }
    EXPECT_LE(farthest, tangent);
    EXPECT_GE(farthest, .9 * tangent);
}

TEST(Navigation, WalkingStaysOnTheLevelAndSettlesAtEyeHeight) {
    Navigation navigation(20);
    navigation.set_mode(NavigationMode::walk);
    CameraRig rig = rig_at({0, 0, 5}, {10, 0, 0});  // looks down
    EXPECT_TRUE(navigation.apply({.keys = {0, 0, 1}, .seconds = 0.1}, rig));
    EXPECT_EQ(rig.position().z, 5);
    EXPECT_NEAR(rig.position().x, 0.1 * navigation.speed(), 1e-12);
    navigation.set_floor(1.0);
    for (int i = 0; i < 200; ++i) navigation.apply({.seconds = 0.02}, rig);
    EXPECT_NEAR(rig.position().z, 1 + navigation.eye_height(), 0.01);
    navigation.set_gravity(false);
    navigation.set_floor(0.0);
    EXPECT_FALSE(navigation.apply({.seconds = 0.1}, rig));
    EXPECT_TRUE(navigation.apply({.keys = {0, 1, 0}, .seconds = 0.1}, rig)) << "without gravity one rises";
}

TEST(Navigation, ModesAreCalledInSettingsAsTheyAreReadFromThem) {
    for (const char* name : {"orbit", "turntable", "fly", "walk"}) {
        const auto mode = navigation_mode(name);
        ASSERT_TRUE(mode);
        EXPECT_STREQ(navigation_name(*mode), name);
    }
    EXPECT_FALSE(navigation_mode("swim"));
}

}  // namespace
}  // namespace lucarne::viewer
