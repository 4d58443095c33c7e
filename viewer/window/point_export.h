#pragma once

#include "viewer/publish/export_worker.h"
#include "viewer/window/view_model.h"

namespace lucarne::viewer {

/// Writes the points that the window shows to a scan file: asks for its name, and shows the progress.
class PointExport {
 public:
    /// `changed` is called by any thread.
    PointExport(ViewModel& model, std::function<void()> changed)
        : model_(model), worker_(std::move(changed)) {}

    /// Call once a frame. Carries out answers and shows outcomes.
    void follow();
    /// Draws the question for the file, and the progress.
    void draw();

 private:
    Result<void> start(const FileQuestion::Answer& answer);

    ViewModel& model_;
    ExportWorker worker_;
};

}  // namespace lucarne::viewer
