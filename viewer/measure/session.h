#pragma once

#include "viewer/measure/section_panel.h"
#include "viewer/measure/worker.h"
#include "viewer/window/view_model.h"

namespace lucarne::viewer {

/// Measuring in the window: turns clicks into points, carries out requests, draws panels and labels.
class MeasureSession {
 public:
    explicit MeasureSession(std::function<void()> wake) : worker_(std::move(wake)) {}

    /// Call take_input() and draw() between the window's begin_frame and draw.
    void take_input(ViewModel& model);
    void draw(ViewModel& model);

 private:
    void take_results(ViewModel& model);
    void follow_section(ViewModel& model);
    void files(ViewModel& model);

    MeasureWorker worker_;
    SectionPanel section_panel_;
};

}  // namespace lucarne::viewer
