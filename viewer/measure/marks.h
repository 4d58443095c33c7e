#pragma once

#include <span>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "viewer/frame/picture_worker.h"
#include "viewer/measure/measurement.h"

namespace lucarne::viewer {

/// What is drawn of measurements over a picture, in pixels of the window.
struct OverlayLine {
    glm::dvec2 from, to;
    bool hidden = false;  ///< behind what the picture shows: to be dimmed
    size_t measurement = 0;
};
struct OverlayMark {
    glm::dvec2 at;
    bool hidden = false;
    size_t measurement = 0;
};
struct OverlayLabel {
    glm::dvec2 at;  ///< its middle
    std::string text;
    bool hidden = false;
    size_t measurement = 0;
};
struct Overlay {
    std::vector<OverlayLine> lines;
    std::vector<OverlayMark> marks;
    std::vector<OverlayLabel> labels;
};

/// `window` in pixels; the picture fills it as Window::show does. Lines are cut into pieces of which each is
/// seen or hidden; what lies behind the camera is left out.
Overlay overlay_of(std::span<const Measurement> all, const Picture& picture, const glm::dvec2& window,
                   const UnitChoice& units);

/// What a label says: the first quantity, or a point's coordinates.
std::string label_text(const Measurement& measurement, const UnitChoice& units);

}  // namespace lucarne::viewer
