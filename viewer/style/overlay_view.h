#pragma once

#include "viewer/overlay/overlay.h"
#include "viewer/style/styling.h"

namespace lucarne::viewer {

/// Returns the view for which overlays are drawn over the window's picture. The model must have a picture.
OverlayView overlay_view(const Styling& model);

}  // namespace lucarne::viewer
