#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gi/device/gl/device.h"
#include "gi/engine.h"
#include "gi/raster/gbuffer.h"
#include "gi/scene/scene.h"
#include "gi/surfels/colouring.h"
#include "gi/surfels/surfel_pool.h"
#include "io/core/options.h"
#include "octree/tree/source.h"
#include "viewer/frame/presets.h"

namespace lucarne::viewer {

/// Caps that hold whatever the cloud's size, bytes.
struct PipelineOptions {
    uint64_t memory = uint64_t{512} << 20;       ///< of the host: the octree's directory, nodes on their way
    uint64_t device_memory = uint64_t{2} << 30;  ///< of all buffers; up to 3/8 of it hold surfels
    unsigned load_threads = 2;
    bool prefetch = true;  ///< loads ahead of a camera that moves, within the caps
};

/// What is used of the caps, bytes.
struct MemoryUse {
    uint64_t host = 0;      ///< the most so far
    uint64_t device = 0;    ///< now
    uint64_t resident = 0;  ///< of the process, as the kernel counts it; with it whatever a driver in
                            ///< software holds for its device
};

struct FrameRequest {
    gi::SceneCamera camera;
    ImageSize size{1280, 720};
    bool wait = false;  ///< loads every cut whole first: the same pixels on every run
    bool accumulate =
        false;            ///< averages with the frames before for as long as nothing that is drawn changes
    bool moving = false;  ///< one of a motion: the engine may use what it knows from the frames before
    Progress* progress = nullptr;  ///< of pixels, for an engine that takes long (EngineInfo)
};

struct FrameStats {
    std::vector<gi::PassTimes::Pass>
        passes;          ///< in order: cuts, load, upload, G-buffer, the engine's, tone map
    double seconds = 0;  ///< the whole frame
    uint64_t view_points = 0, light_view_points = 0, light_points = 0;  ///< drawn
    uint64_t wanted_points = 0, ready_points = 0;  ///< of all cuts, once a cut: chosen and drawn
    uint64_t bytes_loaded = 0;                     ///< since the pipeline was opened
    uint64_t nodes_pending = 0;                    ///< wanted and still on their way
    uint64_t ahead_loads = 0, ahead_hits = 0;      ///< nodes loaded ahead of the camera; of those, seen later
    double cut_share = 1;  ///< of the points that the budgets allow, what fits the caps
    MemoryUse memory;
    uint32_t accumulated = 1;  ///< frames in the picture
    uint64_t nodes_lost = 0;   ///< could not be read and are left out, with their descendants
    std::string lost_node;     ///< why the first of those could not
    std::vector<std::pair<std::string, double>> engine;

    double complete() const {  ///< share of the cuts that is drawn, 0..1
        return wanted_points ? static_cast<double>(ready_points) / static_cast<double>(wanted_points) : 1.0;
    }
};

/// Everything between an octree and a picture: what `render`, `view` and `fly` share. It owns the stream, the
/// surfels on the device, the cuts, the G-buffer, the engine and the buffers of the picture. One thread.
class Pipeline {
 public:
    /// `device` outlives the pipeline. Errors: no device memory; a directory that is larger than the cap.
    static Result<std::unique_ptr<Pipeline>> open(gi::Device& device,
                                                  std::shared_ptr<const octree::NodeSource> source,
                                                  const PipelineOptions& options);
    ~Pipeline();
    Pipeline(const Pipeline&) = delete;
    Pipeline& operator=(const Pipeline&) = delete;

    /// Draws from another source from now on: a build that has grown. The next picture waits for all its
    /// nodes, so that none shows parts of both. Errors: a directory that is larger than the cap; no device
    /// memory.
    Result<void> set_source(std::shared_ptr<const octree::NodeSource> source);

    const octree::NodeSource& source() const;
    const PipelineOptions& options() const;

    /// Errors: unknown name (arguments).
    Result<void> set_engine(std::string_view name);
    void set_settings(const gi::EngineSettings& settings);
    void set_budgets(const CutBudgets& budgets);
    /// Lights, materials, exposure, look. Moving a light is cheap; other materials or colours for the points
    /// send every surfel to the device again, without `wait` one node after another while the old ones are
    /// shown. Lights that are off, and an environment that is, are not there. Another exposure or tone map,
    /// or another way to show a comparison, leaves the average as it is. Errors (arguments): the comparison's
    /// engine is none.
    Result<void> set_scene(gi::Scene scene);

    const gi::EngineInfo& engine() const;
    const gi::EngineSettings& settings() const;
    const CutBudgets& budgets() const;
    const gi::Scene& scene() const;

    /// One frame into radiance() and picture(). Errors: no device memory, the engine's, a context that was
    /// lost (gi::Device::check); with `wait` a node that cannot be read, which is left out otherwise
    /// (FrameStats).
    Result<FrameStats> render(const FrameRequest& request);

    /// Of the last frame: vec4 a pixel (linear radiance, W/(sr m^2)) and RGBA8 (tone-mapped sRGB), row 0 on
    /// top.
    const gi::Buffer& radiance() const;
    const gi::Buffer& picture() const;
    /// What else the engine knows of the pixels, see Engine::layers().
    std::vector<std::vector<glm::vec4>> layers() const;
    /// The last frame's G-buffer and how its coordinates are to be read, for picking and tools.
    const gi::GBuffer& gbuffer() const;
    std::shared_ptr<const gi::CutPoints> points() const;  ///< behind the G-buffer's ids
    const gi::CameraView& camera() const;
    glm::dvec3 local_origin() const;
    /// What the colours of the last picture stand for.
    const gi::ShownValues& values() const;
    /// The stops that the last picture was exposed by (measured where the scene leaves them open).
    double exposure_ev() const;

 private:
    Pipeline();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace lucarne::viewer
