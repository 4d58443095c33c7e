#pragma once

#include "viewer/overlay/overlay.h"
#include "viewer/window/view_model.h"

namespace lucarne::viewer {

/// What is drawn over the window's picture is drawn for this. Needs a picture.
OverlayView overlay_view(const ViewModel& model);

}  // namespace lucarne::viewer
