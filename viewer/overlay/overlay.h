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

/// Something drawn over a picture. Positions are pixels from the picture's top left.
struct Mark {
    enum class Kind : uint8_t { line, area, text } kind = Kind::line;
    glm::dvec2 from{0.0}, to{0.0};  ///< text: `from` is the top left; area: opposite corners
    glm::vec3 colour{1.0f};         ///< sRGB
    float opacity = 1;
    std::string text{};
};

/// The view that marks are drawn for.
struct OverlayView {
    gi::SceneCamera camera;
    double distance = 1;  ///< distance along the view at which the scale bar measures, world units
    double metres_per_unit = 1;
    ImageSize size;
    double font = 13;                        ///< height of the text, pixels
    double left = 0, right = 0, bottom = 0;  ///< margins kept free, pixels
};

/// Returns legend, axes and scale bar, as far as the look requests them.
std::vector<Mark> overlay(const gi::Look& look, const gi::ShownValues& values, const OverlayView& view);

/// The place of the legend's colour bar when colours show a range. The top of the bar is the range's `high`.
struct LegendBar {
    glm::dvec2 from{0.0}, to{0.0};              ///< opposite corners, pixels from the top left
    glm::dvec2 paper_from{0.0}, paper_to{0.0};  ///< corners of the whole legend
};
/// Returns nothing if there is no colour bar.
std::optional<LegendBar> legend_bar(const gi::Look& look, const gi::ShownValues& values,
                                    const OverlayView& view);

/// Returns the range after one end was dragged up by the share `up` of the bar's length. The ends keep at
/// least a hundredth of their distance.
enum class RangeEnd : uint8_t { low, high };
gi::ValueRange dragged_range(const gi::ValueRange& range, RangeEnd end, double up);

/// Returns the legend's title: "Elevation", or an attribute's name.
std::string legend_title(const gi::Look& look);

/// A scale bar of a round length, and its label.
struct ScaleBar {
    double pixels = 0;
    std::string text;
};
/// Returns a scale bar in the scan's unit and, if that is not the metre, a second one in metres. They are at
/// most `most` pixels long. `pixel`: size of a pixel, world units.
std::vector<ScaleBar> scale_bars(double pixel, double metres_per_unit, double most);

/// The direction of an axis (x, y or z) in the picture: shares of its length to the right and down in
/// `place`, and away from the eye in `depth`.
struct Axis {
    glm::dvec2 place{0.0};
    double depth = 0;
};
std::vector<Axis> axes_in(const gi::SceneCamera& camera);

}  // namespace lucarne::viewer
