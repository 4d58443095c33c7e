#pragma once

#include <optional>

#include "viewer/overlay/overlay.h"
#include "viewer/style/styling.h"

namespace lucarne::viewer {

/// Handles at the ends of the legend's colour bar, which the mouse drags to other values. They are shown
/// while the mouse is over the legend.
class LegendHandles {
 public:
    /// Draws the handles and applies the mouse. Returns true while a handle is dragged. A double-click on one
    /// makes the range automatic again.
    bool take(const Styling& model);

 private:
    /// The handle that is dragged, and the state when the drag began.
    struct Held {
        RangeEnd end = RangeEnd::low;
        gi::ValueRange range;
        float y = 0;  ///< the mouse's y, pixels
    };
    std::optional<Held> held_;
};

}  // namespace lucarne::viewer
