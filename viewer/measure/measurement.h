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
    std::string_view name;       ///< in files: "distance"
    std::string_view title;      ///< "Distance"
    std::string_view hint;       ///< which points it takes
    size_t least = 1, most = 1;  ///< points
};
inline constexpr size_t kMostMeasuredPoints = 1000;  ///< of one measurement
const MeasureKindInfo& info_of(MeasureKind kind);
/// In the order of MeasureKind.
std::span<const MeasureKindInfo> measure_kinds();

struct Measurement {
    MeasureKind kind = MeasureKind::point;
    std::string name;
    std::vector<ExactPoint> points;  ///< as many as the kind takes
    double thickness = 0;            ///< section: across the line, world units
};

struct Quantity {
    std::string name;
    double value = 0;  ///< world units, their square, or radians
    Dimension dimension = Dimension::length;
};

/// What is measured; the first is the one that a label shows. All from differences to the first point, so
/// that projected coordinates cost no digits.
///  - distance: length, horizontal, dx, dy, dz;   height: height (of the second over the first), horizontal
///  - angle: at the second point between the others, 0 to pi
///  - path: length, horizontal, and each segment
///  - area: of the polygon seen along its normal by Newell's method (Sutherland, Sproull, Schumacker, "A
///    Characterization of Ten Hidden-Surface Algorithms", 1974): the plane in which it is largest; its
///    horizontal projection; perimeter; the largest distance of a point from the plane
///  - section: length of the line on the map, thickness;   point: none
std::vector<Quantity> quantities(const Measurement& measurement);

}  // namespace lucarne::viewer
