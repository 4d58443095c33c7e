#pragma once

#include "io/input/six_dof.h"
#include "viewer/camera/camera.h"

namespace lucarne::viewer {

/// What the cap of a 6-DoF controller is, in the hand: the camera, or what is looked at.
enum class SixDofHold { camera, object };

/// Moves the camera as the cap says, for so many seconds; at full travel `speed` world units and a quarter
/// turn a second. The object turns about the rig's pivot. The horizon stays level: rolling does nothing. True
/// where the camera moved.
bool drive(const io::SixDofState& cap, SixDofHold hold, double speed, double seconds, CameraRig& rig);

}  // namespace lucarne::viewer
