#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "gi/scene/scene.h"
#include "gi/surfels/colouring.h"
#include "io/core/options.h"

namespace lucarne::viewer {

/// Something drawn over a picture, in its pixels from the top left.
struct Mark {
    enum class Kind : uint8_t { line, area, text } kind = Kind::line;
    glm::dvec2 from{0.0}, to{0.0};  ///< of a text the top left; of an area opposite corners
    glm::vec3 colour{1.0f};         ///< sRGB
    float opacity = 1;
    std::string text{};
};

/// What the marks are of.
struct OverlayView {
    gi::SceneCamera camera;
    double distance = 1;  ///< along the view to what the scale bar measures, world units
    double metres_per_unit = 1;
    ImageSize size;
    double font = 13;                        ///< height of the text, pixels
    double left = 0, right = 0, bottom = 0;  ///< kept free, pixels
};

/// Legend, axes and scale bar, as far as the look asks for them.
std::vector<Mark> overlay(const gi::Look& look, const gi::ShownValues& values, const OverlayView& view);

/// Where the legend's colour bar stands where colours are of a range; its top is the range's `high`. None:
/// there is no such legend.
struct LegendBar {
    glm::dvec2 from{0.0}, to{0.0};              ///< opposite corners, pixels from the top left
    glm::dvec2 paper_from{0.0}, paper_to{0.0};  ///< of the whole legend
};
std::optional<LegendBar> legend_bar(const gi::Look& look, const gi::ShownValues& values,
                                    const OverlayView& view);

/// A range whose one end was dragged up along the bar by a share of its length; the ends keep a hundredth of
/// their distance.
enum class RangeEnd : uint8_t { low, high };
gi::ValueRange dragged_range(const gi::ValueRange& range, RangeEnd end, double up);

/// What a legend is called: "Elevation", or an attribute's name.
std::string legend_title(const gi::Look& look);

/// A bar of a nice length, and what is written beside it.
struct ScaleBar {
    double pixels = 0;
    std::string text;
};
/// In the scan's unit, and in metres where that is another; at most `most` pixels long. `pixel`: world units.
std::vector<ScaleBar> scale_bars(double pixel, double metres_per_unit, double most);

/// Where the axes x, y and z point to in the picture, shares of their length to the right and down; `depth`
/// away from the eye.
struct Axis {
    glm::dvec2 place{0.0};
    double depth = 0;
};
std::vector<Axis> axes_in(const gi::SceneCamera& camera);

}  // namespace lucarne::viewer
