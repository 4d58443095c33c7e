#pragma once

#include <cstdint>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include "gi/device/gl/device.h"
#include "gi/shared/camera.h"

namespace lucarne::gi {

/// How points are drawn for the camera; light views ignore it.
struct PointSize {
    float scale = 1;          ///< scale of the discs' radii
    float pixels = 0;         ///< if over 0: the diameter of every point, which then faces the eye
    float most = 0;           ///< if over 0: the largest diameter of a disc, pixels
    bool front_only = false;  ///< leaves out points whose normals point away from the eye
};

/// A view as disc.glsl describes it: x right, y down, z along the forward axis.
struct DiscView {
    glm::vec4 right, down;  ///< unit; w: tangent of half the field, or half the width or height, m
    glm::vec4 forward;      ///< unit; w: near plane, m
    glm::vec4 origin;       ///< w: 1 if orthographic, else 0
    glm::vec2 shift;        ///< of the rays from the middles of their pixels, pixels
    uint32_t width = 0, height = 0;
    PointSize size;
};

DiscView disc_view(const CameraView& view, const PointSize& size);

/// Sets the uniforms of disc.glsl.
void set_disc_view(const Program& program, const CameraView& view, const PointSize& size);

}  // namespace lucarne::gi
