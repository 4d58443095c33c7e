#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/device/gl/device.h"
#include "gi/raster/gbuffer.h"
#include "gi/scene/environment.h"
#include "gi/scene/look.h"
#include "gi/surfels/surfel_pool.h"
#include "gi/shared/camera.h"
#include "gi/shared/light.h"
#include "gi/shared/material.h"
#include "io/core/progress.h"

namespace lucarne::gi {

/// Everything an engine can be told; presets (viewer/frame/presets.h) fill it. Engines ignore what they do not use.
struct EngineSettings {
    uint32_t bounces = 1;      ///< indirect bounces; 0: direct light alone
    int32_t only_bounce = -1;  ///< >= 0: just that bounce (0: direct light)
    uint32_t vpls = 256;
    uint32_t interleave = 4;          ///< 1, 2 or 4
    uint32_t atlas = 2048;            ///< texels along a side of the ISM atlas
    uint32_t light_resolution = 512;  ///< light G-buffer and shadow map, texels along a side
    uint32_t light_samples = 8;       ///< views a frame of lights that have a size and of the sky (light_samples.h)
    uint32_t samples = 64;            ///< reference: paths a pixel
    bool best_candidate = false;      ///< vpl: redistribute as the paper does, biased (gi/engines/vpl/README.md)
    bool reuse = true;  ///< vpl: moving frames are averaged with those before (gi/engines/vpl/shading/history.h)
    uint64_t seed = 1;

    bool operator==(const EngineSettings&) const = default;
};

/// The cuts of a frame. They may be the same object's content or differ: the view cut is what the camera
/// sees, the light-view cut what lights[i] sees, the light cut covers everything that may bounce or block
/// light.
struct FrameCuts {
    const DeviceCut* view = nullptr;
    std::vector<const DeviceCut*> light_views;  ///< one a light
    const DeviceCut* light = nullptr;
};

struct Bounds {
    glm::vec3 min{0.0f}, max{0.0f};
    bool operator==(const Bounds&) const = default;
};

/// One picture to be lit. `radiance` is vec4 a pixel (rgb W/(sr m^2), w unused), row 0 on top; the engine
/// writes all of it: direct and indirect light, emission, background where the G-buffer is empty.
struct Frame {
    Device& device;
    const SurfelPool& pool;
    FrameCuts cuts;
    CameraView camera;
    const GBuffer& gbuffer;
    std::vector<Light> lights;
    std::vector<Material> materials;
    glm::vec3 background{0.0f};
    EngineSettings settings;
    uint64_t index = 0;  ///< of the frame: engines that accumulate take new samples for each
    Buffer& radiance;
    PassTimes& times;
    std::shared_ptr<const Environment> environment;  ///< lights, and is seen in the place of `background`
    Bounds bounds{};                                 ///< of the whole cloud, m
    bool moving = false;  ///< one of a motion: what the frame before knew may serve
    Progress* progress = nullptr;                    ///< of engines that report it; or none
    Unlit unlit{};                                   ///< of the engine without light
};

struct EngineInfo {
    std::string_view name;         ///< as --engine takes it
    std::string_view description;  ///< one line
    /// Pictures that it keeps beside the radiance (Engine::layers), as parts of files' names.
    std::span<const std::string_view> layers = {};
    bool reports_progress = false;  ///< takes long, and adds the pixels that it finishes to Frame::progress
    bool unlit = false;  ///< knows no light: its colours are shown as they are, without exposure or tone curve
};

/// A way to light a G-buffer. `info / prepare / render / stats`; one folder an engine.
class Engine {
 public:
    virtual ~Engine() = default;
    virtual const EngineInfo& info() const = 0;
    /// Once per scene, device or settings change that needs new resources; cheap when nothing changed.
    virtual Result<void> prepare(Frame& frame) = 0;
    virtual Result<void> render(Frame& frame) = 0;
    /// Figures of the last frame for statistics and reports ("vpls": 256).
    virtual std::vector<std::pair<std::string, double>> stats() const = 0;
    /// Of info().layers, in their order: vec4 a pixel, of all frames that were accumulated so far.
    virtual std::vector<std::vector<glm::vec4>> layers() const { return {}; }
};

}  // namespace lucarne::gi
