#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "viewer/flythrough/path.h"
#include "viewer/frame/picture_worker.h"
#include "viewer/opening/site.h"
#include "viewer/publish/finished_picture.h"
#include "viewer/publish/single_order.h"

namespace lucarne::viewer {

/// One picture, saved as PNG.
struct StillOrder {
    gi::SceneCamera camera;
    uint32_t frames = 1;  ///< averaged
    PictureFinish finish;
    std::filesystem::path file;
};

/// Every frame of a path, with every cut whole.
struct FlightOrder {
    CameraPath path;
    std::filesystem::path frames_folder;  ///< empty: none
    std::filesystem::path video;          ///< empty: none
};

/// What to render, and with which scene and settings. Existing files are not overwritten.
struct RenderOrder {
    std::shared_ptr<const octree::NodeSource> source;
    gi::Scene scene;
    Method method;
    PipelineOptions caps;  ///< in addition to the memory of the window's pipeline
    ImageSize size;
    Site site;  ///< decides from where rooms are looked into
    std::variant<StillOrder, FlightOrder> what;
};

struct RenderState {
    bool running = false;
    size_t done = 0, total = 0;  ///< frames
    std::string file;
};

/// A thread that renders pictures and flights like `render` and `fly`, with its own device and pipeline,
/// while the window stays usable. Call the members from one thread; they never wait.
class RenderWorker {
 public:
    /// `changed` is called, by any thread, when state() or take_outcome() has something new.
    explicit RenderWorker(std::function<void()> changed) : work_(std::move(changed)) {}

    /// Starts an order. Returns false and does nothing while another order is running. The device is released
    /// before the order ends.
    bool start(RenderOrder order, WorkerDevice device);
    /// Cancels after the current frame. Written frames stay; an unfinished video is removed.
    void cancel() { work_.cancel(); }
    RenderState state() const { return work_.shown(); }
    /// Returns the last order's outcome once: what was written, or the error.
    std::optional<Result<std::string>> take_outcome() { return work_.take_outcome(); }

 private:
    Result<void> frame_done();
    Result<std::string> render(const RenderOrder& order, const WorkerDevice& device);
    Result<std::string> draw(const RenderOrder& order, const WorkerDevice& device);
    Result<std::string> still(Pipeline& pipeline, const RenderOrder& order, const StillOrder& what);
    Result<std::string> flight(Pipeline& pipeline, const RenderOrder& order, const FlightOrder& what);

    SingleOrder<RenderState> work_;
};

}  // namespace lucarne::viewer
