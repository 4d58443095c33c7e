#pragma once

#include <optional>

#include "viewer/overlay/overlay.h"
#include "viewer/window/view_model.h"

namespace lucarne::viewer {

/// The ends of the legend's colour bar, which the mouse drags to other values; they show where it is over the
/// legend.
class LegendHandles {
 public:
    /// True while one is dragged. A double-click on one makes the range automatic again.
    bool take(ViewModel& model);

 private:
    /// What was seized, and as it was then.
    struct Held {
        RangeEnd end = RangeEnd::low;
        gi::ValueRange range;
        float y = 0;  ///< of the mouse, pixels
    };
    std::optional<Held> held_;
};

}  // namespace lucarne::viewer
