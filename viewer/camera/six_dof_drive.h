#pragma once

#include "io/input/six_dof.h"
#include "viewer/camera/camera.h"

namespace lucarne::viewer {

/// What the cap of a 6-DoF controller moves: the camera, or the object that the camera looks at.
enum class SixDofHold { camera, object };

/// Moves the camera by the cap's deflection for `seconds`: at full travel `speed` world units and a quarter
/// turn a second. SixDofHold::object turns the object about the rig's pivot. The horizon stays level: roll
/// has no effect. Returns true if the camera moved.
bool drive(const io::SixDofState& cap, SixDofHold hold, double speed, double seconds, CameraRig& rig);

}  // namespace lucarne::viewer
