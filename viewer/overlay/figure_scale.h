#pragma once

#include <vector>

#include "viewer/overlay/overlay.h"

namespace lucarne::viewer {

/// What the colours of false-colour luminance (cd/m^2) or of a difference between two engines stand for, at
/// the bottom; nothing where the picture is a picture. `ev` is the picture's exposure.
std::vector<Mark> figure_scale(const gi::Scene& scene, double ev, const OverlayView& view);

}  // namespace lucarne::viewer
