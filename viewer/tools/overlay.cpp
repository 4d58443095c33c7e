#include "viewer/tools/overlay.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "viewer/tools/pick.h"

namespace lucarne::viewer {
namespace {

constexpr int kPieces = 48;  ///< of a line, each seen or hidden

class Layout {
 public:
    Layout(const Picture& picture, const glm::dvec2& window, Overlay& overlay)
        : picture_(picture), overlay_(overlay) {
        const glm::dvec2 size(picture.size.width, picture.size.height);
        scale_ = std::max(window.x / size.x, window.y / size.y);
        corner_ = window / 2.0 - size * scale_ / 2.0;
    }

    void mark(const glm::dvec3& world, size_t measurement) {
        if (const auto at = place(world)) overlay_.marks.push_back({at->first, at->second, measurement});
    }
    void label(const glm::dvec3& world, std::string text, size_t measurement) {
        if (const auto at = place(world))
            overlay_.labels.push_back({at->first, std::move(text), at->second, measurement});
    }
    /// Neighbouring pieces that are seen alike are one line.
    void line(const glm::dvec3& from, const glm::dvec3& to, size_t measurement) {
        auto before = place(from);
        bool open = false;
        for (int i = 1; i <= kPieces; ++i) {
            const auto at = place(from + (to - from) * (static_cast<double>(i) / kPieces));
            if (at && before) {
                const bool hidden_piece = at->second && before->second;
                if (open && overlay_.lines.back().hidden == hidden_piece)
                    overlay_.lines.back().to = at->first;
                else
                    overlay_.lines.push_back({before->first, at->first, hidden_piece, measurement});
            }
            open = at && before;
            before = at;
        }
    }

 private:
    std::optional<std::pair<glm::dvec2, bool>> place(const glm::dvec3& world) const {
        const auto projected = project(picture_, world);
        if (!projected || glm::length(projected->pixel) > 1e6) return std::nullopt;
        return std::pair(corner_ + projected->pixel * scale_, hidden(picture_, *projected));
    }

    const Picture& picture_;
    Overlay& overlay_;
    double scale_ = 1;
    glm::dvec2 corner_{0.0};
};

std::vector<glm::dvec3> positions(const Measurement& m) {
    std::vector<glm::dvec3> all;
    for (const ExactPoint& point : m.points) all.push_back(point.position);
    return all;
}

/// The edges of a slice on the map, at the height of its ends.
void slice_lines(Layout& layout, const Measurement& m, const std::vector<glm::dvec3>& at, size_t index) {
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

void add(Layout& layout, const Measurement& m, size_t index, const UnitChoice& units) {
    const std::vector<glm::dvec3> at = positions(m);
    if (at.empty()) return;
    for (const glm::dvec3& point : at) layout.mark(point, index);
    glm::dvec3 middle(0.0);
    for (const glm::dvec3& point : at) middle += (point - at[0]) / static_cast<double>(at.size());
    middle += at[0];
    if (m.kind == MeasureKind::height && at.size() == 2) {
        const glm::dvec3 foot(at[1].x, at[1].y,
                              at[0].z);  // the difference stands over the first point's level
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
    Layout layout(picture, window, overlay);
    for (size_t i = 0; i < all.size(); ++i) add(layout, all[i], i, units);
    return overlay;
}

}  // namespace lucarne::viewer
