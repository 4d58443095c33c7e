#include "viewer/camera/six_dof_drive.h"

#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace lucarne::viewer {
namespace {

CameraRig rig_at_origin() {
    gi::SceneCamera camera;
    camera.position = {0, 0, 0};
    camera.target = {0, 10, 0};
    return CameraRig(camera);
}

io::SixDofState push(const glm::dvec3& by) {
    return {by, glm::dvec3(0.0), 0};
}
io::SixDofState turn(const glm::dvec3& by) {
    return {glm::dvec3(0.0), by, 0};
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b) {
    EXPECT_LT(glm::distance(a, b), 1e-9) << a.x << " " << a.y << " " << a.z;
}

TEST(SixDofDrive, TheCameraGoesWhereItIsPushed) {
    CameraRig rig = rig_at_origin();
    EXPECT_TRUE(drive(push({1, 0.5, -0.25}), SixDofHold::camera, 4, 0.125, rig));
    expect_near(rig.position(), {0.5, -0.125, 0.25});
    EXPECT_FALSE(drive({}, SixDofHold::camera, 4, 0.125, rig));
    EXPECT_FALSE(drive(push({1, 0, 0}), SixDofHold::camera, 4, 0, rig));
}

TEST(SixDofDrive, TheCameraLooksWhereItIsTurned) {
    CameraRig rig = rig_at_origin();
    for (int i = 0; i < 4; ++i) drive(turn({0, 1, 0}), SixDofHold::camera, 1, 0.25, rig);
    expect_near(rig.forward(), {-1, 0, 0});
    drive(turn({1, 0, 0}), SixDofHold::camera, 1, 0.25, rig);
    EXPECT_GT(rig.forward().z, 0) << "nose up";
    expect_near(rig.position(), {0, 0, 0});
}

TEST(SixDofDrive, TheObjectTurnsAboutThePivotAndComesAlong) {
    CameraRig rig = rig_at_origin();
    drive(turn({0, 1, 0}), SixDofHold::object, 1, 0.25, rig);
    EXPECT_NEAR(glm::distance(rig.position(), rig.pivot()), 10, 1e-9);
    EXPECT_LT(rig.position().x, 0) << "counterclockwise from above: its near side goes to the right";
    rig = rig_at_origin();
    drive(push({0, 0, 1}), SixDofHold::object, 1, 0.25, rig);
    EXPECT_GT(glm::distance(rig.position(), rig.pivot()), 10) << "pushed away";
    rig = rig_at_origin();
    drive(push({1, 0, 0}), SixDofHold::object, 1, 0.25, rig);
    EXPECT_LT(rig.position().x, 0) << "the object goes to the right";
}

TEST(SixDofDrive, ASlowFrameDoesNotThrowTheCameraAway) {
    CameraRig slow = rig_at_origin(), usual = rig_at_origin();
    drive(push({0, 0, 1}), SixDofHold::camera, 1, 100, slow);
    drive(push({0, 0, 1}), SixDofHold::camera, 1, 0.25, usual);
    expect_near(slow.position(), usual.position());
}

}  // namespace
}  // namespace lucarne::viewer
