#pragma once

#include "viewer/publish/publishing.h"
#include "viewer/publish/render_worker.h"

namespace lucarne::viewer {

/// Pictures and flights in the window: carries out requests and moves the camera with the preview.
class PublishSession {
 public:
    /// `device` makes a new device for each order. `changed` is called by any thread.
    PublishSession(std::function<Result<WorkerDevice>()> device, std::function<void()> changed)
        : device_(std::move(device)), worker_(std::move(changed)) {}

    /// Call between the window's begin_frame and draw. Returns true if the preview has moved the camera.
    bool follow(const Publishing& model, const std::shared_ptr<const octree::NodeSource>& source);

 private:
    void carry_out(const Publishing& model, const std::shared_ptr<const octree::NodeSource>& source);
    void path_files(const Publishing& model, bool save);
    Result<void> render(RenderOrder order);

    std::function<Result<WorkerDevice>()> device_;
    RenderWorker worker_;
};

}  // namespace lucarne::viewer
