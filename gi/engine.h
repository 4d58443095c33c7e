#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/device/gl/device.h"
#include "gi/options.h"
#include "gi/raster/gbuffer.h"
#include "gi/scene/environment.h"
#include "gi/scene/look.h"
#include "gi/shared/camera.h"
#include "gi/shared/light.h"
#include "gi/shared/material.h"
#include "gi/surfels/surfel_pool.h"
#include "io/core/progress.h"

namespace lucarne::gi {

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
    bool moving = false;           ///< one of a motion: what the frame before knew may serve
    Progress* progress = nullptr;  ///< of engines that report it; or none
    Unlit unlit{};                 ///< of the engine without light
};

/// What others need to know of an engine, without building it. One constant, in the engine's folder.
struct EngineInfo {
    std::string_view name;         ///< as --engine takes it
    std::string_view description;  ///< one line
    std::span<const OptionInfo* const> options = {};
    /// Pictures that it keeps beside the radiance (Engine::layers), as parts of files' names.
    std::span<const std::string_view> layers = {};
    bool reports_progress = false;  ///< takes long, and adds the pixels that it finishes to Frame::progress
    /// Knows no light: its colours are shown as they are, without exposure or tone curve.
    bool unlit = false;
    bool direct_only = false;   ///< no light from surface to surface: what the others add shows beside it
    bool is_reference = false;  ///< converges to the truth: what the others are compared with
};

/// A way to light a G-buffer; one folder an engine, which exports one EngineEntry.
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

/// An engine, and how it is made.
struct EngineEntry {
    const EngineInfo& info;
    std::unique_ptr<Engine> (*make)();
};

}  // namespace lucarne::gi
