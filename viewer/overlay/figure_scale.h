#pragma once

#include <vector>

#include "viewer/overlay/overlay.h"

namespace lucarne::viewer {

/// Returns a scale for the bottom of the picture that explains the colours of false-colour luminance (cd/m^2)
/// or of a difference between two engines. Returns nothing for ordinary pictures. `ev` is the picture's
/// exposure.
std::vector<Mark> figure_scale(const gi::Scene& scene, double ev, const OverlayView& view);

}  // namespace lucarne::viewer
