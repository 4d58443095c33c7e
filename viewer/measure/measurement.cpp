#include "viewer/measure/measurement.h"

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace lucarne::viewer {
namespace {

using glm::dvec3;

constexpr std::array<MeasureKindInfo, 7> kKinds = {{
    {"point", "Point", "a point", "the exact coordinates and all attributes of a point", 1, 1},
    {"distance", "Distance", "two points", "the length between two points, along the map and along each axis",
     2, 2},
    {"height", "Height", "the lower and the upper point", "how much higher the second point lies", 2, 2},
    {"angle", "Angle", "three points; the angle is at the second", "the angle between two directions", 3, 3},
    {"area", "Area", "the corners in turn; Enter ends",
     "the area and the perimeter of a polygon, in its plane and on the map", 3, kMostMeasuredPoints},
    {"path", "Path", "the points in turn; Enter ends", "the length of a line through several points", 2,
     kMostMeasuredPoints},
    {"section", "Section", "the two ends of the line to cut along",
     "a cut through the scan: its points within the thickness, seen from the side", 2, 2},
}};

double on_map(const dvec3& v) {
    return std::hypot(v.x, v.y);
}

std::vector<Quantity> distance(const dvec3& d) {
    return {{"length", glm::length(d)}, {"horizontal", on_map(d)}, {"dx", d.x}, {"dy", d.y}, {"dz", d.z}};
}

std::vector<Quantity> path(const std::vector<dvec3>& at) {
    std::vector<Quantity> all = {{"length", 0}, {"horizontal", 0}};
    for (size_t i = 1; i < at.size(); ++i) {
        const dvec3 step = at[i] - at[i - 1];
        all[0].value += glm::length(step);
        all[1].value += on_map(step);
        all.push_back({fmt::format("segment {}", i), glm::length(step)});
    }
    return all;
}

double angle(const dvec3& a, const dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));  // exact near 0 and pi, unlike acos
}

std::vector<Quantity> area(const std::vector<dvec3>& at) {
    dvec3 twice(0.0), middle(0.0);
    double perimeter = 0;
    for (size_t i = 0; i < at.size(); ++i) {
        const dvec3& next = at[(i + 1) % at.size()];
        twice += glm::cross(at[i], next);
        middle += at[i] / static_cast<double>(at.size());
        perimeter += glm::distance(at[i], next);
    }
    const double length = glm::length(twice);
    double off_plane = 0;
    for (const dvec3& p : at)
        if (length > 0) off_plane = std::max(off_plane, std::abs(glm::dot(p - middle, twice / length)));
    return {{"area", length / 2, Dimension::area},
            {"horizontal area", std::abs(twice.z) / 2, Dimension::area},
            {"perimeter", perimeter},
            {"off plane", off_plane}};
}

}  // namespace

std::span<const MeasureKindInfo> measure_kinds() {
    return kKinds;
}

const MeasureKindInfo& info_of(MeasureKind kind) {
    return kKinds[static_cast<size_t>(kind)];
}

std::vector<Quantity> quantities(const Measurement& measurement) {
    if (measurement.points.size() < info_of(measurement.kind).least) return {};
    std::vector<dvec3> at;  // relative to the first point
    for (const ExactPoint& point : measurement.points)
        at.push_back(point.position - measurement.points.front().position);
    switch (measurement.kind) {
        case MeasureKind::point:
            return {};
        case MeasureKind::distance:
            return distance(at[1]);
        case MeasureKind::height:
            return {{"height", at[1].z}, {"horizontal", on_map(at[1])}};
        case MeasureKind::angle:
            return {{"angle", angle(at[0] - at[1], at[2] - at[1]), Dimension::angle}};
        case MeasureKind::area:
            return area(at);
        case MeasureKind::path:
            return path(at);
        case MeasureKind::section:
            break;
    }
    return {{"length", on_map(at[1])}, {"thickness", measurement.thickness}};
}

}  // namespace lucarne::viewer
