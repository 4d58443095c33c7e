#include "octree/normals/surface/crease.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "octree/normals/surface/surface_sample.h"
#include "octree/normals/surface/surface_share.h"

namespace lucarne::octree {
namespace {

constexpr size_t kSectors = 16;
/// Sectors that are fitted together: 112 degrees. A corner of three planes leaves 90.
constexpr size_t kRun = 5;
constexpr size_t kLeastRun = 6;  ///< points of a run
/// A side has at least one of so many points of the patch. A plane across the two faces of a thin wall has
/// fewer.
constexpr size_t kLeastPart = 3;
constexpr size_t kLeastSide = 8;  ///< points of each of two planes at a crease
/// Points within this many deviations of a plane belong to it. Where there is no noise, within this share of
/// the spacing.
constexpr float kInliers = 3.0f, kInSpacing = 0.05f;
constexpr float kLeastOffset = 0.1f;  ///< in spacings: a point's cell reaches at least so far to the crease
constexpr double kTurned = 0.91;      ///< largest |n.n'| of two planes at a crease: 24 degrees
constexpr int kRefits = 2;

void add(Moments& to, const Moments& other) {
    to.count += other.count;
    for (size_t i = 0; i < 3; ++i) to.sum[i] += other.sum[i];
    for (size_t i = 0; i < 6; ++i) to.products[i] += other.products[i];
}

/// Returns the sector of a direction, counted around the circle.
size_t sector_of(float u, float v) {
    constexpr float kEighth = 0.41421356f;  // tan 22.5 degrees
    const float a = std::abs(u), b = std::abs(v);
    const bool steep = b > a;
    const size_t half = std::min(a, b) > kEighth * std::max(a, b);
    size_t sector = steep ? 3 - half : half;  // 0 .. 3 in the first quarter
    if (u < 0) sector = 7 - sector;
    if (v < 0) sector = 15 - sector;
    return sector;
}

/// Estimates how well a plane fits to points whose sums are `m`, and to the origin: the variance of the
/// points' heights plus the squared height of the origin. The least eigenvalue of the covariance is close to
/// its determinant divided by the sum of its principal minors, if the others are much larger, and the normal
/// is close to the largest column of the adjugate matrix.
float misfit(const Moments& m) {
    const float n = static_cast<float>(m.count), x = m.sum[0] / n, y = m.sum[1] / n, z = m.sum[2] / n;
    const auto squares = [&](size_t i, float mean) { return m.products[i] / n - mean; };
    const float trace = squares(0, x * x) + squares(1, y * y) + squares(2, z * z);
    if (!(trace > 0)) return std::numeric_limits<float>::max();
    // In units of the trace, because floats cannot represent the products of any three variances.
    const float xx = squares(0, x * x) / trace, yy = squares(1, y * y) / trace,
                zz = squares(2, z * z) / trace, xy = squares(3, x * y) / trace,
                xz = squares(4, x * z) / trace, yz = squares(5, y * z) / trace;
    const float a = yy * zz - yz * yz, b = xx * zz - xz * xz, c = xx * yy - xy * xy, minors = a + b + c;
    if (!(minors > 0)) return std::numeric_limits<float>::max();  // on a line
    const glm::vec3 columns[] = {{a, xz * yz - xy * zz, xy * yz - xz * yy},
                                 {xz * yz - xy * zz, b, xy * xz - yz * xx},
                                 {xy * yz - xz * yy, xy * xz - yz * xx, c}};
    const glm::vec3& column = columns[a >= b && a >= c ? 0 : b >= c ? 1 : 2];
    const float least = std::max(0.0f, (xx * columns[0].x + xy * columns[0].y + xz * columns[0].z) / minors);
    const float height = glm::dot(column, glm::vec3(x, y, z));
    return trace * least * n / (n - 3) + height * height / glm::dot(column, column);
}

/// The variance of heights over a plane that was fitted to `count` points.
double variance_of(const Plane& plane, size_t count) {
    const double n = static_cast<double>(count);
    return plane.variances[0] * n / (n - 3);
}

float limit_of(const Plane& plane, size_t count, float spacing) {
    return std::max(kInliers * static_cast<float>(std::sqrt(variance_of(plane, count))),
                    kInSpacing * spacing);
}

glm::dvec3 middle_of(const Moments& m) {
    return glm::dvec3(m.sum[0], m.sum[1], m.sum[2]) / static_cast<double>(m.count);
}

/// Returns the sums over the run of sectors that fits best; no points if all runs are too short.
Moments best_run(const Patch& patch, const TangentFrame& frame) {
    std::array<Moments, kSectors> sectors{};
    for (size_t i = 0; i < patch.count; ++i) {
        const glm::vec3 p = patch.offset(i);
        if (p == glm::vec3(0.0f)) continue;
        Moments& m = sectors[sector_of(glm::dot(frame.x, p), glm::dot(frame.y, p))];
        ++m.count;
        m.sum[0] += p.x, m.sum[1] += p.y, m.sum[2] += p.z;
        m.products[0] += p.x * p.x, m.products[1] += p.y * p.y, m.products[2] += p.z * p.z;
        m.products[3] += p.x * p.y, m.products[4] += p.x * p.z, m.products[5] += p.y * p.z;
    }
    float least = std::numeric_limits<float>::max();
    Moments best;
    for (size_t first = 0; first < kSectors; ++first) {
        Moments run;
        for (size_t i = 0; i < kRun; ++i) add(run, sectors[(first + i) % kSectors]);
        if (run.count < kLeastRun) continue;
        if (const float off = misfit(run); off < least) least = off, best = run;
    }
    return best;
}

}  // namespace

void CreaseFitter::divide(const Patch& patch, const Moments& own, const Plane& plane, float limit) {
    const glm::vec3 normal(plane.normal);
    const auto level = static_cast<float>(glm::dot(plane.normal, middle_of(own)));
    heights_over(patch, normal, heights_);
    for (Patch* part : {&own_, &others_}) {
        part->clear();
        part->make_room(patch.count);
    }
    for (size_t i = 0; i < patch.count; ++i) {
        const bool is_own = patch.distance2[i] == 0 || std::abs(heights_[i] - level) <= limit;
        (is_own ? own_ : others_).push_back(patch.offset(i), patch.index[i]);
    }
    own_.pad();
    others_.pad();
}

std::optional<Side> CreaseFitter::fit(const Patch& patch, const glm::vec3& normal, float spacing) {
    Moments own = best_run(patch, tangent_frame(normal));
    if (own.count == 0) return std::nullopt;
    Side side;
    side.plane = plane_of(own);
    side.count = own.count;
    for (int refit = 0; refit < kRefits; ++refit) {
        divide(patch, own, side.plane, limit_of(side.plane, side.count, spacing));
        if (own_.count < std::max(kLeastSide, patch.count / kLeastPart) || others_.count < kLeastSide)
            return std::nullopt;
        own = moments_of(own_);
        side.plane = plane_of(own);
        side.count = own_.count;
    }
    const Moments rest = moments_of(others_);
    const Plane other = plane_of(rest);
    if (std::abs(glm::dot(other.normal, side.plane.normal)) > kTurned) return std::nullopt;

    side.variance = static_cast<float>(variance_of(side.plane, side.count));
    side.deviation = deviation_of(side.plane, side.count);
    const float limit = limit_of(side.plane, side.count, spacing);
    const glm::dvec3 middle = middle_of(own);
    const auto level = static_cast<float>(glm::dot(side.plane.normal, middle));
    side.layer = {std::min(0.0f, level - limit), std::max(0.0f, level + limit)};
    side.other = glm::vec3(other.normal);
    const double offset = glm::dot(other.normal, middle_of(rest));
    // The side's points tell on which side of the other plane it lies; noise may put the point across.
    const bool below = glm::dot(other.normal, middle) < offset, across = below != (0 < offset);
    const float least = kLeastOffset * spacing;
    side.offset = static_cast<float>(offset);
    if (std::abs(side.offset) < (across ? std::max(2 * limit, least) : least))
        side.offset = below ? least : -least;
    return side;
}

}  // namespace lucarne::octree
