#pragma once

#include <vector>

#include "gi/frame.h"
#include "gi/lighting/sky_directions.h"

namespace lucarne::gi {

/// A light that a shadow map can hold, and the cut that its views are drawn from.
struct SharpLight {
    Light light;
    const DeviceCut* cut;
};

/// The frame's lights, those that have a size in the form of sharp ones that stand for them this frame: of
/// the sun directions within its cap, of rectangles and discs points that shine as the cosine, of the sky
/// (`sky`, of the frame's environment) directions by its luminance. They are stratified, and others for each
/// Frame::index: the average over frames goes to the light with its size. kLightSamples views are
/// shared out among those lights, at least one sample each; black ones have none.
std::vector<SharpLight> sharp_lights(const Frame& frame, const SkyDirections& sky);

/// Faces, and so views, of a light (light_face() in gi/shared/light.h).
uint32_t light_faces(const Light& light);

}  // namespace lucarne::gi
