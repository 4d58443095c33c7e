#pragma once

#include "viewer/overlay/overlay.h"
#include "viewer/window/view_model.h"

namespace lucarne::viewer {

/// Returns the view for which overlays are drawn over the window's picture. The model must have a picture.
OverlayView overlay_view(const ViewModel& model);

}  // namespace lucarne::viewer
