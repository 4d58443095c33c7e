#include "viewer/camera/fitting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

namespace lucarne::viewer {
namespace {

/// Share of the free part that the points fill at most.
constexpr double kFilled = .94;

struct Interval {
    double low, high;
    double middle() const { return (low + high) / 2; }
};

/// The free part with its margin, as tangents or shares of half the picture's height.
struct Limits {
    Interval across, upward;
};

Interval within(double low, double high) {
    const double least = .05;  // a part that is covered wholly is as good as none
    const double middle = (low + high) / 2, half = std::max((high - low) / 2, least) * kFilled;
    return {middle - half, middle + half};
}

Limits limits_of(const PictureShape& shape, double half_height) {
    Interval across = within(shape.free.left, shape.free.right),
             upward = within(shape.free.bottom, shape.free.top);
    across.low *= half_height * shape.aspect;
    across.high *= half_height * shape.aspect;
    upward.low *= half_height;
    upward.high *= half_height;
    return {across, upward};
}

/// The four planes of the view's pyramid, moved until all points are inside: for each axis of the picture the
/// least of x - tangent * depth at the low side, and the largest at the high side.
struct Planes {
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    void add(double x, double depth, const Interval& tangents) {
        lowest = std::min(lowest, x - tangents.low * depth);
        highest = std::max(highest, x - tangents.high * depth);
    }
    /// The farthest forward that the camera may be.
    double depth(const Interval& tangents) const {
        return (lowest - highest) / (tangents.high - tangents.low);
    }
    /// The place between both planes for a camera at `depth`.
    double place(double depth, const Interval& tangents) const {
        return (lowest + tangents.low * depth + highest + tangents.high * depth) / 2;
    }
};

glm::dvec3 seen(const ViewAxes& axes, const glm::dvec3& p) {
    return {dot(p, axes.right), dot(p, axes.up), dot(p, axes.forward)};
}
glm::dvec3 world(const ViewAxes& axes, const glm::dvec3& p) {
    return axes.right * p.x + axes.up * p.y + axes.forward * p.z;
}

}  // namespace

std::array<glm::dvec3, 2> widened(const std::array<glm::dvec3, 2>& box, double reach, double least) {
    const glm::dvec3 low = box[0] - reach, high = box[1] + reach, sides = high - low;
    if (!(std::max({sides.x, sides.y, sides.z}) < least)) return {low, high};
    const glm::dvec3 middle = (low + high) / 2.0;
    return {middle - least / 2, middle + least / 2};
}

glm::dvec3 fitting_position(std::span<const glm::dvec3> points, const ViewAxes& axes, double vertical_fov,
                            const PictureShape& shape, double span) {
    const Limits limits = limits_of(shape, std::tan(vertical_fov / 2));
    Planes across, upward;
    double nearest = std::numeric_limits<double>::infinity();
    for (const glm::dvec3& point : points) {
        const glm::dvec3 p = seen(axes, point);
        if (!std::isfinite(p.x + p.y + p.z)) continue;
        across.add(p.x, p.z, limits.across);
        upward.add(p.y, p.z, limits.upward);
        nearest = std::min(nearest, p.z);
    }
    if (!std::isfinite(nearest)) return glm::dvec3(0);
    const double depth =
        std::min({across.depth(limits.across), upward.depth(limits.upward), nearest - std::max(span, 1e-9)});
    return world(axes, {across.place(depth, limits.across), upward.place(depth, limits.upward), depth});
}

ParallelFit parallel_fit(std::span<const glm::dvec3> points, const ViewAxes& axes, const PictureShape& shape,
                         double span) {
    const double far = std::numeric_limits<double>::infinity();
    glm::dvec3 low(far), high(-far);
    for (const glm::dvec3& point : points) {
        const glm::dvec3 p = seen(axes, point);
        if (!std::isfinite(p.x + p.y + p.z)) continue;
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    if (!std::isfinite(low.x)) return {glm::dvec3(0), std::max(span, 1e-9)};
    const Limits limits = limits_of(shape, .5);  // of a picture of height 1
    const double height = std::max({(high.x - low.x) / (limits.across.high - limits.across.low),
                                    (high.y - low.y) / (limits.upward.high - limits.upward.low), span});
    const glm::dvec3 middle((low.x + high.x) / 2 - limits.across.middle() * height,
                            (low.y + high.y) / 2 - limits.upward.middle() * height, low.z - height);
    return {world(axes, middle), height};
}

}  // namespace lucarne::viewer
