#pragma once

#include <vector>

#include "gi/engine.h"

namespace lucarne::gi {

/// A view from a light, to be drawn with rasterize() as its G-buffer and shadow map. Spots and directional
/// lights have one, point lights six: the faces of a cube (cube_face() in gi/shared/light.h).
struct LightView {
    size_t light;  ///< of the frame
    uint32_t face;
    CameraView view;
};

/// Whether a shadow map can hold the light: the others shine from areas.
inline bool casts_shadow_map(const Light& light) {
    return light.kind <= kDirectionalLight;
}

/// Of all lights that a shadow map can hold, settings.light_resolution texels along a side. That of a
/// directional light takes in the frame's bounds: a pinhole so far away that its rays part by less than a
/// texel over the scene's height.
std::vector<LightView> light_views(const Frame& frame);

}  // namespace lucarne::gi
