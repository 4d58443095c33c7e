#pragma once

#include <span>

#include "viewer/measure/model.h"
#include "viewer/ui/action.h"
#include "viewer/ui/view.h"

namespace lucarne::viewer {

/// What the actions and panels of measuring act on.
struct Measuring {
    View& view;
    MeasureModel& measure;
};

std::span<const Action<const Measuring>> measure_actions();
void draw_measure_panel(const Measuring& model);  ///< tools, measurements, points
void draw_measurements(const Measuring& model);   ///< drawn over the picture

}  // namespace lucarne::viewer
