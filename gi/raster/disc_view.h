#pragma once

#include "gi/device/gl/device.h"
#include "gi/shared/camera.h"

namespace lucarne::gi {

/// The size at which points are drawn for the camera; light views ignore it.
struct PointSize {
    float scale = 1;   ///< scale of the discs' radii
    float pixels = 0;  ///< if over 0: the diameter of every point, which then faces the eye
};

/// Sets the uniforms of disc.glsl.
void set_disc_view(const Program& program, const CameraView& view, const PointSize& size);

}  // namespace lucarne::gi
