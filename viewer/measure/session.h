#pragma once

#include "viewer/measure/measuring.h"
#include "viewer/measure/section_panel.h"
#include "viewer/measure/worker.h"

namespace lucarne::viewer {

/// Measuring in the window: turns clicks into points, carries out requests, draws panels and labels.
class MeasureSession {
 public:
    explicit MeasureSession(std::function<void()> wake) : worker_(std::move(wake)) {}

    /// Call take_input() and draw() between the window's begin_frame and draw.
    void take_input(const Measuring& model);
    void draw(const Measuring& model);

 private:
    void take_results(const Measuring& model);
    void follow_section(const Measuring& model);
    void carry_out(const Measuring& model);
    void save(const Measuring& model);
    void load(const Measuring& model);
    void save_section(const Measuring& model);

    MeasureWorker worker_;
    SectionPanel section_panel_;
};

}  // namespace lucarne::viewer
