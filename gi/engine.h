#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/vec4.hpp>

#include "gi/changes.h"
#include "gi/frame.h"
#include "gi/options.h"
#include "io/core/error.h"

namespace lucarne::gi {

struct Precomputes;

/// What an engine reads beside the picture of the view. Only this is chosen, loaded and sent to the device.
struct EngineNeeds {
    bool light_cut = false;    ///< FrameCuts::light, on which light bounces and by which it is blocked
    bool light_views = false;  ///< FrameCuts::light_views
    bool opencl = false;       ///< an OpenCL device
    /// The needs of both: of two engines for one frame.
    EngineNeeds operator|(const EngineNeeds& other) const {
        return {light_cut || other.light_cut, light_views || other.light_views, opencl || other.opencl};
    }
    bool operator==(const EngineNeeds&) const = default;
};

/// What the rest of the program needs to know of an engine without making it. It is one constant in the
/// engine's folder.
struct EngineInfo {
    std::string_view name;         ///< as --engine takes it
    std::string_view label;        ///< what people see in the window: "Path tracer"
    std::string_view description;  ///< one line
    std::span<const OptionInfo* const> options = {};
    EngineNeeds needs = {};
    /// What it computes in advance (gi/bake/precomputation.h); null: nothing.
    const Precomputes* precomputes = nullptr;
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
    /// Lights a frame: update(), prepare(), render(). Errors: the settings, device memory, the engine's own.
    Result<void> draw(Frame& frame);
    /// Returns figures of the last frame for statistics and reports ("vpls": 256).
    virtual std::vector<std::pair<std::string, double>> stats() const = 0;
    /// Whether the engine is making light from the light cuts over several frames (Frame::light_budget).
    /// Keep these cuts unchanged while this is true; a changed cut restarts the computation.
    virtual bool reads_light_cuts() const { return false; }
    /// Whether frames of a motion that make little light (Frame::light_budget) take little time although the
    /// engine is slow, because it keeps the light of a finished frame with this content and these settings.
    virtual bool keeps_light(const EngineSettings& settings, uint64_t content) const {
        static_cast<void>(settings), static_cast<void>(content);
        return false;
    }
    /// Returns the pictures of info().layers, in their order: a vec4 per pixel, over all frames accumulated
    /// so far.
    virtual std::vector<std::vector<glm::vec4>> layers() const { return {}; }

 protected:
    /// Called once before each frame is drawn. Engines that keep results from frame to frame drop here, or
    /// mark, what no longer holds.
    virtual void update(const Changes& changes) { static_cast<void>(changes); }
    /// Checks the settings and makes the resources that they need; cheap when nothing changed.
    virtual Result<void> prepare(Frame& frame) = 0;
    /// Writes the frame's radiance.
    virtual Result<void> render(Frame& frame) = 0;

 private:
    ChangeTracker tracker_;
};

/// An engine and the function that makes it.
struct EngineEntry {
    const EngineInfo& info;
    std::unique_ptr<Engine> (*make)();
};

}  // namespace lucarne::gi
