#include "viewer/measure/marks.h"

#include <algorithm>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "viewer/measure/marks_layout.h"

namespace lucarne::viewer {
namespace {

std::vector<glm::dvec3> positions(const Measurement& m) {
    std::vector<glm::dvec3> all;
    for (const ExactPoint& point : m.points) all.push_back(point.position);
    return all;
}

/// Adds the edges of a slice in plan view, at the height of its ends.
void slice_lines(OverlayLayout& layout, const Measurement& m, const std::vector<glm::dvec3>& at,
                 size_t index) {
    const glm::dvec2 along(at[1].x - at[0].x, at[1].y - at[0].y);
    const double length = glm::length(along);
    if (!(length > 0)) return;
    const glm::dvec3 side = glm::dvec3(-along.y, along.x, 0) / length * (m.thickness / 2);
    for (const double s : {-1.0, 1.0}) {
        layout.line(at[0] + side * s, at[1] + side * s, index);
        const glm::dvec3& end = s < 0 ? at[0] : at[1];
        layout.line(end - side, end + side, index);
    }
}

void add(OverlayLayout& layout, const Measurement& m, size_t index, const UnitChoice& units) {
    const std::vector<glm::dvec3> at = positions(m);
    if (at.empty()) return;
    for (const glm::dvec3& point : at) layout.mark(point, index);
    glm::dvec3 middle(0.0);
    for (const glm::dvec3& point : at) middle += (point - at[0]) / static_cast<double>(at.size());
    middle += at[0];
    if (m.kind == MeasureKind::height && at.size() == 2) {
        const glm::dvec3 foot(at[1].x, at[1].y,
                              at[0].z);  // the difference is drawn from the first point's height
        layout.line(at[0], foot, index);
        layout.line(foot, at[1], index);
        middle = (foot + at[1]) / 2.0;
    } else {
        for (size_t i = 1; i < at.size(); ++i) layout.line(at[i - 1], at[i], index);
        if (m.kind == MeasureKind::area && at.size() > 2) layout.line(at.back(), at.front(), index);
    }
    if (m.kind == MeasureKind::section && at.size() == 2) slice_lines(layout, m, at, index);
    if (m.kind == MeasureKind::angle && at.size() > 1) middle = at[1];
    if (m.kind == MeasureKind::path) {
        middle = at.back();
        for (size_t i = 1; i < at.size() && at.size() > 2; ++i)
            layout.label((at[i - 1] + at[i]) / 2.0,
                         units.text(glm::distance(at[i - 1], at[i]), Dimension::length), index);
    }
    if (std::string text = label_text(m, units); !text.empty()) layout.label(middle, std::move(text), index);
}

}  // namespace

std::string label_text(const Measurement& measurement, const UnitChoice& units) {
    if (measurement.kind == MeasureKind::point && !measurement.points.empty()) {
        const auto& [x, y, z] = measurement.points.front().coordinates;
        return fmt::format("{} {} {}", x, y, z);
    }
    const auto all = quantities(measurement);
    return all.empty() ? std::string() : units.text(all.front().value, all.front().dimension);
}

Overlay overlay_of(std::span<const Measurement> all, const Picture& picture, const glm::dvec2& window,
                   const UnitChoice& units) {
    Overlay overlay;
    OverlayLayout layout(picture, window, overlay);
    for (size_t i = 0; i < all.size(); ++i) add(layout, all[i], i, units);
    return overlay;
}

}  // namespace lucarne::viewer
