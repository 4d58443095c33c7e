#pragma once

#include <string_view>

#include "gi/device/device.h"
#include "gi/shared/camera.h"
#include "gi/shared/material.h"

namespace lucarne::gi {

/// Sets a uniform of the struct's own name in GLSL: `uniform CameraView camera;`, `uniform SpotLight spot;`.
void set(const Program& program, std::string_view uniform, const CameraView& view);
void set(const Program& program, std::string_view uniform, const SpotLight& spot);

}  // namespace lucarne::gi
