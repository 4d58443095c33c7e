#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "viewer/flythrough/path.h"
#include "viewer/frame/picture_worker.h"
#include "viewer/publish/finished_picture.h"

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

/// What is to be rendered, and with what. Nothing that exists is written over.
struct RenderOrder {
    std::shared_ptr<const octree::NodeSource> source;
    gi::Scene scene;
    std::string engine;
    gi::EngineSettings settings;
    CutBudgets budgets;
    PipelineOptions caps;  ///< beside what the window's pipeline takes
    ImageSize size;
    std::variant<StillOrder, FlightOrder> what;
};

struct RenderState {
    bool running = false;
    size_t done = 0, total = 0;  ///< frames
    std::string file;
};

/// A thread that renders pictures and flights with a device and a pipeline of their own, as `render` and
/// `fly` do, while the window goes on. Members are called by one thread and never wait.
class RenderWorker {
 public:
    /// `changed`: state() or take_outcome() has something new; any thread.
    explicit RenderWorker(std::function<void()> changed);
    ~RenderWorker();  ///< cancels; after the frame being made
    RenderWorker(const RenderWorker&) = delete;
    RenderWorker& operator=(const RenderWorker&) = delete;

    /// False, and nothing happens, while another order is at work. The device is let go of before that ends.
    bool start(RenderOrder order, WorkerDevice device);
    /// After the frame being made. Frames that were written stay; a video does not.
    void cancel();
    RenderState state() const;
    /// Of the last order, once: what was written, or the error.
    std::optional<Result<std::string>> take_outcome();

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace lucarne::viewer
