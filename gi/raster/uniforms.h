#pragma once

#include <string_view>

#include "gi/device/gl/device.h"
#include "gi/shared/camera.h"
#include "gi/shared/light.h"
#include "gi/shared/material.h"

namespace lucarne::gi {

/// Set a uniform struct of the same type in GLSL: `uniform CameraView camera;`, `uniform Light light;`.
void set(const Program& program, std::string_view uniform, const CameraView& view);
void set(const Program& program, std::string_view uniform, const Light& light);

}  // namespace lucarne::gi
