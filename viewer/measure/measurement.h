#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "viewer/inputs/units.h"
#include "viewer/picking/exact_point.h"

namespace lucarne::viewer {

enum class MeasureKind { point, distance, height, angle, area, path, section };

struct MeasureKindInfo {
    std::string_view name;       ///< name in files: "distance"
    std::string_view title;      ///< "Distance"
    std::string_view hint;       ///< tells the user which points to click
    const char* help;            ///< what is measured
    size_t least = 1, most = 1;  ///< points
};
inline constexpr size_t kMostMeasuredPoints = 1000;  ///< limit for one measurement
const MeasureKindInfo& info_of(MeasureKind kind);
/// All kinds in the order of MeasureKind.
std::span<const MeasureKindInfo> measure_kinds();

struct Measurement {
    MeasureKind kind = MeasureKind::point;
    std::string name;
    std::vector<ExactPoint> points;  ///< as many as the kind needs
    double thickness = 0;            ///< of a section: width across the line, world units
};

struct Quantity {
    std::string name;
    double value = 0;  ///< world units, their square, or radians
    Dimension dimension = Dimension::length;
};

/// Returns the quantities of a measurement; labels show the first. They are computed from differences to the
/// first point, so that large projected coordinates do not cost precision.
///  - distance: length, horizontal, dx, dy, dz;   height: height (of the second point above the first),
///    horizontal
///  - angle: at the second point between the others, 0 to pi
///  - path: length, horizontal, and each segment
///  - area: of the polygon seen along its normal by Newell's method (Sutherland, Sproull, Schumacker, "A
///    Characterization of Ten Hidden-Surface Algorithms", 1974): the plane in which it is largest; its
///    horizontal projection; perimeter; the largest distance of a point from the plane
///  - section: length of the line on the map, thickness;   point: none
std::vector<Quantity> quantities(const Measurement& measurement);

}  // namespace lucarne::viewer
