#pragma once

#include <span>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "viewer/frame/picture_worker.h"
#include "viewer/measure/measurement.h"

namespace lucarne::viewer {

/// The following are drawn for measurements over a picture. Positions are pixels of the window.
struct OverlayLine {
    glm::dvec2 from, to;
    bool hidden = false;  ///< behind the visible surface; drawn dimmed
    size_t measurement = 0;
};
struct OverlayMark {
    glm::dvec2 at;
    bool hidden = false;
    size_t measurement = 0;
};
struct OverlayLabel {
    glm::dvec2 at;  ///< centre of the text
    std::string text;
    bool hidden = false;
    size_t measurement = 0;
};
struct Overlay {
    std::vector<OverlayLine> lines;
    std::vector<OverlayMark> marks;
    std::vector<OverlayLabel> labels;
};

/// Returns what to draw for all measurements. `window` is its size in pixels; the picture fills it as in
/// Window::show. Lines are split into pieces that are either visible or hidden. Parts behind the camera are
/// left out.
Overlay overlay_of(std::span<const Measurement> all, const Picture& picture, const glm::dvec2& window,
                   const UnitChoice& units);

/// Returns a label's text: the first quantity, or a point's coordinates.
std::string label_text(const Measurement& measurement, const UnitChoice& units);

}  // namespace lucarne::viewer
