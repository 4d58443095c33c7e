#pragma once

#include <vector>

#include "gi/device/gl/device.h"
#include "gi/device/gl/pass_times.h"
#include "gi/raster/gbuffer.h"
#include "gi/surfels/surfel_pool.h"

namespace lucarne::gi {

/// The cuts of a frame. Two of them may have the same content. Those of the light are there if the engine
/// needs them (EngineInfo::needs).
struct FrameCuts {
    const DeviceCut* view = nullptr;            ///< what the camera sees
    std::vector<const DeviceCut*> light_views;  ///< what each light sees; one a light, or none
    const DeviceCut* light = nullptr;           ///< everything that may bounce or block light; or null
};

/// The part of a frame that is on the OpenGL device. `radiance` is vec4 a pixel (rgb W/(sr m^2), w unused),
/// row 0 on top; the engine writes all of it: direct and indirect light, emission, and the background where
/// the G-buffer is empty.
struct GlFrame {
    Device& device;
    const SurfelPool& pool;
    FrameCuts cuts;
    const GBuffer& gbuffer;
    Buffer& radiance;
};

}  // namespace lucarne::gi
