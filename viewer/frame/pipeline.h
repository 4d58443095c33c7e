#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gi/bake/bake_job.h"
#include "gi/device/gl/device.h"
#include "gi/device/gl/pass_times.h"
#include "gi/engine.h"
#include "gi/raster/gbuffer.h"
#include "gi/scene/scene.h"
#include "gi/surfels/colouring.h"
#include "gi/surfels/surfel_pool.h"
#include "io/core/options.h"
#include "octree/tree/source.h"
#include "viewer/frame/presets.h"

namespace lucarne::viewer {

/// Memory caps, bytes, which hold for clouds of any size.
struct PipelineOptions {
    uint64_t memory = uint64_t{512} << 20;  ///< of the host: the octree's directory and nodes on their way
    uint64_t device_memory = uint64_t{2} << 30;  ///< of all buffers; up to 3/8 of it hold surfels
    unsigned load_threads = 2;
    bool prefetch = true;  ///< loads ahead of a moving camera, within the caps
};

/// Memory use, bytes.
struct MemoryUse {
    uint64_t host = 0;      ///< largest use so far
    uint64_t device = 0;    ///< now
    uint64_t resident = 0;  ///< of the process, by the kernel; with a software driver includes `device`
};

/// Most pixels of a point while more of them are to come (FrameRequest::most_pixels).
inline constexpr float kSketchDots = 4;

struct FrameRequest {
    gi::SceneCamera camera;
    ImageSize size{1280, 720};
    bool wait = false;         ///< loads complete cuts first: the same pixels on every run
    bool complete = false;     ///< likewise, but leaves out nodes that cannot be read
    bool accumulate = false;   ///< averages with earlier frames as long as nothing drawn changes
    bool antialiased = true;   ///< softens edges: by coverage in the first frame, by other rays in the next
                               ///< ones of an average
    bool transparent = false;  ///< keeps the points' light apart from the background in averages
    /// If over 0: the largest diameter of a point in the picture, pixels. Gaps between points are filled.
    double most_pixels = 0;
    bool front_only = false;  ///< as gi::Look::front_only
    bool moving = false;      ///< a frame of a motion: the engine may reuse data of earlier frames
    /// For motion in real time: how much of the light that outlasts a frame is made
    /// (gi::Frame::light_budget).
    gi::StepBudget light_budget{};
    double exposure_seconds = 0;  ///< time in which automatic exposure follows by 63 %; 0: at once
    /// Lets gi::stand_in_engine() draw in the place of one that takes long, and leaves a compared engine out
    /// that does.
    bool stand_in = false;
    /// Likewise, as long as nodes are on their way, and for an engine that computes in advance until it has
    /// anything to show.
    bool stand_in_early = false;
    /// An engine whose precomputation runs whatever engine draws; empty: only that of the one that draws, if
    /// it has one.
    std::string prepares;
    uint64_t prepares_again = 0;  ///< a changed number restarts a precomputation that has failed
    /// How pictures are made at rest; none: as this one. Precomputations are made for its settings and
    /// budgets, so that a motion that reduces them starts none again.
    std::optional<Method> at_rest;
    bool colours_only = false;  ///< shows the points' colours without light: the fastest picture
    const std::atomic<bool>* stop = nullptr;  ///< gives the frame up once it is true (or null)
    Progress* progress = nullptr;             ///< counts pixels, for slow engines (EngineInfo)
};

struct FrameStats {
    std::vector<gi::PassTimes::Pass>
        passes;          ///< in order: cuts, load, upload, G-buffer, the engine's passes, tone map
    double seconds = 0;  ///< the whole frame
    uint64_t view_points = 0, light_view_points = 0, light_points = 0;  ///< drawn
    uint64_t wanted_points = 0, ready_points = 0;  ///< summed over all cuts: points chosen and drawn
    uint64_t bytes_loaded = 0;                     ///< since the pipeline was opened
    uint64_t nodes_pending = 0;                    ///< wanted nodes that are still on their way
    uint64_t ahead_loads = 0, ahead_hits = 0;      ///< nodes loaded ahead; later visible
    double cut_share = 1;  ///< share of the points allowed by the budgets that fits the caps
    MemoryUse memory;
    uint32_t accumulated = 1;  ///< frames in the picture
    bool given_up = false;     ///< FrameRequest::stop: there is no new picture
    /// The finished share of what is computed in advance, 0..1 (1: it is also kept, or cannot be); none if
    /// nothing is.
    std::optional<double> prepared;
    std::string prepared_for;             ///< for which engine; empty: none
    std::filesystem::path prepared_file;  ///< that holds it; empty: none does
    std::string not_prepared;             ///< why it failed
    uint64_t prepares_again = 0;          ///< as in the request
    std::string not_kept;                 ///< why no file holds it
    uint64_t nodes_lost = 0;              ///< unreadable nodes, which are left out with their descendants
    std::string lost_node;                ///< why the first of these could not be read
    std::vector<std::pair<std::string, double>> engine;
    std::string lit_by;         ///< the name of the engine that drew the picture
    std::string compared_with;  ///< and of the one that it is compared with; empty: none has drawn

    double complete() const {  ///< share of the cuts that is drawn, 0..1
        return wanted_points ? static_cast<double>(ready_points) / static_cast<double>(wanted_points) : 1.0;
    }
};

/// Everything between an octree and a picture; `render`, `view` and `fly` share it. It owns the stream, the
/// surfels on the device, the cuts, the G-buffer, the engine and the buffers of the picture. Use from one
/// thread.
class Pipeline {
 public:
    /// `device` must outlive the pipeline. Errors: no device memory; the directory is larger than the cap.
    static Result<std::unique_ptr<Pipeline>> open(gi::Device& device,
                                                  std::shared_ptr<const octree::NodeSource> source,
                                                  const PipelineOptions& options);
    ~Pipeline();
    Pipeline(const Pipeline&) = delete;
    Pipeline& operator=(const Pipeline&) = delete;

    /// Draws from another source from now on, for example a build that has grown. The next picture waits for
    /// all its nodes, so that no picture shows parts of both sources. Errors: the directory is larger than
    /// the cap; no device memory.
    Result<void> set_source(std::shared_ptr<const octree::NodeSource> source);

    const octree::NodeSource& source() const;
    const PipelineOptions& options() const;

    /// Errors (arguments): unknown name.
    Result<void> set_engine(std::string_view name);
    /// Sets the engine, unless it is the present one, and its settings and budgets. Errors: no such engine.
    Result<void> set_method(const Method& method);
    void set_settings(const gi::EngineSettings& settings);
    void set_budgets(const CutBudgets& budgets);
    /// Sets lights, materials, exposure and look. Moving a light is cheap. Other materials or colours of
    /// points send every surfel to the device again; without `wait` this happens node by node while the old
    /// surfels are drawn. Lights and an environment that are switched off are ignored. A change of exposure,
    /// tone map or the display of a comparison keeps the average. Errors (arguments): the comparison's engine
    /// is unknown.
    Result<void> set_scene(gi::Scene scene);

    /// Sets a function that is called when the engine's precomputation has news: on another thread, and by
    /// render() when another begins or none is left. Another picture is worth making if it has another bake
    /// or has ended. Call before the first render().
    void on_prepared(std::function<void(const gi::BakeJob::Status&)> published);
    /// Computes in advance all that the engine asks for with the present settings and scene, as render() with
    /// `wait` does, and keeps it. Returns the file; empty if there is no place for it. `progress` counts
    /// thousandths. Errors: it fails; it cannot be kept. An engine that computes nothing in advance is done
    /// at once.
    Result<std::filesystem::path> prepare(Progress* progress = nullptr);

    const gi::EngineInfo& engine() const;
    const gi::EngineSettings& settings() const;
    const CutBudgets& budgets() const;
    const gi::Scene& scene() const;

    /// Renders one frame into radiance() and picture(). Errors: no device memory; those of the engine; the
    /// context was lost (gi::Device::check); with `wait`, a node cannot be read. Without `wait` such nodes
    /// are left out (FrameStats).
    Result<FrameStats> render(const FrameRequest& request);

    /// The last frame's radiance (vec4 a pixel, linear, W/(sr m^2)) and picture (RGBA8, tone-mapped sRGB),
    /// row 0 on top.
    const gi::Buffer& radiance() const;
    /// The radiance of the last frame alone, each pixel that of the surface in the G-buffer.
    const gi::Buffer& surface_radiance() const;
    const gi::Buffer& picture() const;
    /// The radiance without the background, in pixels that show a point; with the share of the pixel that
    /// shows points in w. Averages need FrameRequest::transparent for that.
    std::vector<glm::vec4> points_radiance() const;
    /// Returns the engine's further data of the pixels, see Engine::layers().
    std::vector<std::vector<glm::vec4>> layers() const;
    /// The last frame's G-buffer and the meaning of its coordinates, for picking and tools. In averages the
    /// rays of each frame pass through their pixels in another place, the camera's shift.
    const gi::GBuffer& gbuffer() const;
    std::shared_ptr<const gi::CutPoints> points() const;  ///< maps the G-buffer's ids to points
    const gi::CameraView& camera() const;
    glm::dvec3 local_origin() const;
    /// Returns the meaning of the last picture's colours.
    const gi::ShownValues& values() const;
    /// Returns the exposure of the last picture in stops (measured if the scene does not set it).
    double exposure_ev() const;

 private:
    Pipeline();
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace lucarne::viewer
