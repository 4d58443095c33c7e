#pragma once

#include <span>
#include <vector>

#include "gi/lighting/light_samples.h"

namespace lucarne::gi {

/// A view from a light, to be drawn with rasterize() as its G-buffer and shadow map. Spots and directional
/// lights have one, point lights six: the faces of a cube; samples of areas four: the quarters of the half
/// space that they shine into (light_face() in gi/shared/light.h).
struct LightView {
    Light light;  ///< sharp
    const DeviceCut* cut;
    uint32_t face;
    CameraView view;
};

/// Of all lights of the frame (`sky` of its environment), kLightResolution texels along a side, of
/// points of areas half as many. That of a directional light takes in the frame's bounds, a rectangle of as
/// many texels: a pinhole so far away that its rays part by less than a texel over the scene's height.
std::vector<LightView> light_views(const Frame& frame, const SkyDirections& sky);

}  // namespace lucarne::gi
