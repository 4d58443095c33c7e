#pragma once

#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "gi/lighting/light_samples.h"

namespace lucarne::gi {

/// A view from a light; rasterize() draws its G-buffer, which is also its shadow map. Spots have one view.
/// Point lights have six, the faces of a cube. Samples of areas have four, the quarters of the half space
/// into which they shine. Directional lights of large scans have some, one within the other (nested_views.h).
/// light_face() in gi/shared/light.h tells which of them shows a point.
struct LightView {
    Light light;  ///< sharp
    const DeviceCut* cut;
    uint32_t face;
    CameraView view;
    bool of_sky = false;  ///< of a light that stands in for the sky
};

/// A rectangle perpendicular to a direction that covers a box as seen along it, about the middle of the box,
/// m.
struct Outline {
    glm::vec3 right, up;  // unit
    glm::vec2 half;
};

/// Returns the smallest of some rectangles turned about the direction, so that few texels miss the scene.
Outline outline_along(const Bounds& bounds, const glm::vec3& direction);

/// Returns the views of all lights of the frame (`sky` is that of its environment; `index` in place of
/// Frame::index chooses the samples of lights with a size), with kLightResolution
/// texels along a side, half as many for points of areas. The widest view of a directional light covers the
/// bounds of the frame with a rectangle of as many texels; its pinhole is so far away that its rays diverge
/// by less than a texel over the height of the scene.
std::vector<LightView> light_views(const Frame& frame, const SkyDirections& sky, uint64_t index);

}  // namespace lucarne::gi
