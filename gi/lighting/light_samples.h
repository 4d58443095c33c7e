#pragma once

#include <vector>

#include "gi/frame.h"
#include "gi/lighting/sky_directions.h"

namespace lucarne::gi {

class DeviceCut;

/// A light without a size, which a shadow map can represent, and the cut from which its views are drawn.
struct SharpLight {
    Light light;
    const DeviceCut* cut;
    bool of_sky = false;  ///< stands in for the sky
};

/// Returns the lights of the frame. Lights with a size are replaced by sharp lights that stand in for them
/// in this frame: a sun by directions within its cap, rectangles and discs by points that emit with the
/// cosine, the sky (`sky`, of the frame's environment) by directions in proportion to its luminance. The
/// samples are stratified and differ for each `index`, for example Frame::index, so the average over frames
/// converges to the light with its size. kLightSamples views are shared out among those lights, at least one
/// sample each; black lights get none.
std::vector<SharpLight> sharp_lights(const Frame& frame, const SkyDirections& sky, uint64_t index);

/// Returns `count` directional lights that stand in for a sky, which must not be dark: directions in
/// proportion to its luminance, stratified, and others for each `index`, `seed` and number `light`.
std::vector<Light> sky_lights(const SkyDirections& sky, uint32_t count, uint64_t index, uint64_t seed,
                              uint64_t light);

/// Returns whether a light sends out any light.
bool shines(const Light& light);

/// Returns the number of faces of a light, and so of its views (light_face() in gi/shared/light.h).
uint32_t light_faces(const Light& light);

}  // namespace lucarne::gi
