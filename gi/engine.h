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

/// The cuts of a frame; several may be the same cut. The view cut is what the camera sees, light_views[i] is
/// what lights[i] sees, and the light cut covers everything that may bounce or block light.
struct FrameCuts {
    const DeviceCut* view = nullptr;
    std::vector<const DeviceCut*> light_views;  ///< one per light
    const DeviceCut* light = nullptr;
};

struct Bounds {
    glm::vec3 min{0.0f}, max{0.0f};
    bool operator==(const Bounds&) const = default;
};

/// One picture to be lit. `radiance` has a vec4 per pixel (rgb W/(sr m^2), w unused), row 0 on top. The
/// engine writes all of it: direct and indirect light, emission, and the background where the G-buffer is
/// empty.
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
    uint64_t index = 0;  ///< of the frame; engines that accumulate draw new samples for each index
    Buffer& radiance;
    PassTimes& times;
    std::shared_ptr<const Environment> environment;  ///< lights, and replaces `background`; may be null
    Bounds bounds{};                                 ///< of the whole cloud, m
    bool moving = false;           ///< part of a motion: the engine may reuse results of the last frame
    Progress* progress = nullptr;  ///< of engines that report it; may be null
    Unlit unlit{};                 ///< settings of the engine without light
};

/// What the rest of the program needs to know of an engine without making it. It is one constant in the
/// engine's folder.
struct EngineInfo {
    std::string_view name;         ///< as --engine takes it
    std::string_view description;  ///< one line
    std::span<const OptionInfo* const> options = {};
    /// Pictures that it keeps beside the radiance (Engine::layers); their names become parts of file names.
    std::span<const std::string_view> layers = {};
    bool reports_progress = false;  ///< takes long, and adds finished pixels to Frame::progress
    /// Ignores light: its colours are shown as they are, without exposure or tone curve.
    bool unlit = false;
    bool direct_only = false;   ///< computes no light from surface to surface
    bool is_reference = false;  ///< converges to the truth; other engines are compared with it
};

/// Lights a G-buffer. Each engine has a folder of its own, which exports one EngineEntry.
class Engine {
 public:
    virtual ~Engine() = default;
    virtual const EngineInfo& info() const = 0;
    /// Call before render(). It takes the resources that the frame's scene, device or settings need; cheap
    /// when nothing changed.
    virtual Result<void> prepare(Frame& frame) = 0;
    virtual Result<void> render(Frame& frame) = 0;
    /// Returns figures of the last frame for statistics and reports ("vpls": 256).
    virtual std::vector<std::pair<std::string, double>> stats() const = 0;
    /// Returns the pictures of info().layers, in their order: a vec4 per pixel, over all frames accumulated
    /// so far.
    virtual std::vector<std::vector<glm::vec4>> layers() const { return {}; }
};

/// An engine and the function that makes it.
struct EngineEntry {
    const EngineInfo& info;
    std::unique_ptr<Engine> (*make)();
};

}  // namespace lucarne::gi
