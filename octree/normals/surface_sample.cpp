#include "octree/normals/surface_sample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

#include "octree/normals/normals.h"

namespace lucarne::octree {
namespace {

constexpr size_t kLeastLayer = 6;  ///< fewer points say nothing about a layer of their own
/// Layers are apart by this share of the neighbourhood's thickness (Gaussian noise leaves such a gap among 17
/// points once in 2^16), and by this share of the spacing: closer ones are the noise, rounding or
/// registration of one.
constexpr float kLayerGap = 0.4f, kLayerSpacing = 0.5f;
/// The nearest of 16 neighbours in a plane is at this share of the farthest once in 2^18 (Poisson); a point
/// out in the air sees all of a surface from afar and has no share of it.
constexpr float kIsolated = 0.75f;
/// A few points hanging in the air together (mixed pixels behind an edge) have each other, and then nothing
/// up to the surfaces around, whose points stand much closer: the distance to the 8th neighbour over that of
/// the neighbours to their own 2nd is about 2 within a surface, 3 on its edge, and 4 along the lines of the
/// most uneven scanner.
constexpr size_t kOwnRank = 8, kTheirRank = 2;
constexpr float kSparser = 7.0f;  // not one of 200,000 points of a random pattern
/// But a sparse point beside a dense patch that lies in the patch's plane, within this share of its distance
/// or this many deviations of the patch's own heights, goes on with its surface.
constexpr float kInPlane = 0.03f, kInNoise = 3.0f;
/// ... unless it is farther from the patch than this many of its spacings: too far for its plane to tell.
constexpr float kMostApart = 10.0f;
/// Coordinates are rounded in files (LAS: millimetres): variances below this share of the widest are not
/// trusted.
constexpr double kVarianceFloor = 1e-6;

/// The squared distance from near[i] to its kTheirRank-th nearest among `near`, the point itself left out.
float their_reach2(std::span<const glm::vec3> near, size_t i) {
    std::array<float, kTheirRank> best;  // ascending
    best.fill(std::numeric_limits<float>::max());
    for (size_t j = 1; j < near.size(); ++j) {
        const glm::vec3 apart = near[i] - near[j];
        const float d2 = glm::dot(apart, apart);
        if (j == i || d2 >= best.back()) continue;
        size_t at = kTheirRank - 1;
        for (; at > 0 && best[at - 1] > d2; --at) best[at] = best[at - 1];
        best[at] = d2;
    }
    return best.back();
}

/// Whether their_reach2(near, i) is less than `limit2`.
bool reaches_within(std::span<const glm::vec3> near, size_t i, float limit2) {
    size_t within = 0;  // itself included
    for (size_t j = 1; j < near.size(); ++j) {
        const glm::vec3 apart = near[i] - near[j];
        within += glm::dot(apart, apart) < limit2;
    }
    return within > kTheirRank;
}

/// Whether the neighbourhood of the point is much sparser than those of its neighbours (as the local outlier
/// factor compares them: Breunig et al. 2000), from the neighbours' distances among themselves. Within a
/// surface the first neighbour asked ends it.
bool stands_apart(std::span<const glm::vec3> near) {
    if (near.size() <= kOwnRank) return false;
    const float limit = glm::dot(near[kOwnRank], near[kOwnRank]) / (kSparser * kSparser);
    if (!reaches_within(near, near.size() - 1, limit) && !reaches_within(near, kOwnRank, limit)) return false;
    size_t denser = 0;
    for (size_t i = 1; i < near.size(); ++i) denser += reaches_within(near, i, limit);
    return 2 * denser >= near.size() - 1;
}

/// The share that the neighbours of a point in the air have: what it is to be drawn with, having none of its
/// own.
float share_of_neighbours(std::span<const glm::vec3> near) {
    std::array<float, kMostSampled> reaches;
    for (size_t i = 1; i < near.size(); ++i) reaches[i - 1] = their_reach2(near, i);
    const auto median = reaches.begin() + static_cast<ptrdiff_t>((near.size() - 1) / 2);
    std::nth_element(reaches.begin(), median, reaches.begin() + static_cast<ptrdiff_t>(near.size() - 1));
    return std::numbers::pi_v<float> * *median / kTheirRank;
}

float deviation_of(const Plane& plane, size_t points) {
    const double n = static_cast<double>(points);
    const double widest = plane.variances[2];
    if (!(widest > 0) || points < 4) return 10.0f;
    // The plane has taken three degrees of freedom from the residuals.
    const double noise = plane.variances[0] * n / (n - 3) + kVarianceFloor * widest;
    double variance = 0;
    for (const size_t axis : {1, 2}) {
        const double gap = plane.variances[axis] - noise;
        if (!(gap > 0)) return 10.0f;
        variance += noise * plane.variances[axis] / (n * gap * gap);
    }
    return static_cast<float>(std::min(10.0, std::sqrt(variance)));
}

/// The range of heights of the layer that holds the point itself, which is at 0.
struct Layer {
    float low, high;
    bool holds(float height) const { return height >= low && height <= high; }
};
/// A gap of nearly half the range or more is looked for at the middle of it.
Layer own_layer(std::span<const float> heights, float spacing) {
    const auto [lowest, highest] = std::minmax_element(heights.begin(), heights.end());
    const float low = *lowest, high = *highest, middle = (low + high) / 2;
    float below = low, above = high;
    size_t lower = 0;
    for (const float h : heights) {
        if (h < middle) {
            below = std::max(below, h);
            ++lower;
        } else {
            above = std::min(above, h);
        }
    }
    const bool own_is_lower = middle > 0;
    const size_t own = own_is_lower ? lower : heights.size() - lower;
    if (above - below < std::max(kLayerGap * (high - low), kLayerSpacing * spacing) || own < kLeastLayer)
        return {low, high};
    return own_is_lower ? Layer{low, below} : Layer{above, high};
}

bool lies_in_plane_of_others(std::span<const glm::vec3> near, PlaneFitter& fitter) {
    const auto others = near.subspan(1);
    const Plane plane = fitter.fit(others);
    if (deviation_of(plane, others.size()) > kGoodDeviation) return false;
    double height = 0;
    for (const auto& other : others) height += glm::dot(glm::dvec3(other), plane.normal);
    height /= static_cast<double>(others.size());
    return std::abs(height) <= kInPlane * glm::length(near[1]) + kInNoise * std::sqrt(plane.variances[0]);
}

ShareCell cell_of(std::span<const glm::vec3> offsets, std::span<const float> heights, const glm::vec3& normal,
                  const Layer& layer) {
    ShareCell cell(normal, glm::length(offsets.back()), offsets.size() - 1);
    const float highest = std::max(-layer.low, layer.high);
    for (size_t i = 1; i < offsets.size(); ++i) {
        const float widest = cell.widest_cut();
        if (glm::dot(offsets[i], offsets[i]) - highest * highest >= widest * widest) break;
        if (layer.holds(heights[i])) cell.cut(offsets[i]);
    }
    return cell;
}

}  // namespace

SurfaceSample sample_surface(std::span<const glm::vec3> offsets, size_t area_count, bool whole_cloud,
                             PlaneFitter& fitter) {
    SurfaceSample sample;
    if (offsets.size() < 4) return sample;
    const auto near = offsets.first(std::min(offsets.size(), area_count));
    const float reach2 = glm::dot(near.back(), near.back());
    const bool sees_from_afar = glm::dot(near[1], near[1]) > kIsolated * kIsolated * reach2;
    if (!whole_cloud && near.size() > kOwnRank && (sees_from_afar || stands_apart(offsets))) {
        sample.area = kStrayArea;
        const bool near_enough =
            glm::dot(near[1], near[1]) < kMostApart * kMostApart * share_of_neighbours(offsets);
        if (!near_enough || !lies_in_plane_of_others(near, fitter)) return sample;
        sample.apart = true;
    }

    Plane plane = fitter.fit(offsets);
    std::array<float, kMostSampled> heights;
    for (size_t i = 0; i < offsets.size(); ++i) heights[i] = glm::dot(offsets[i], glm::vec3(plane.normal));
    const float spacing = std::sqrt(std::numbers::pi_v<float> * reach2 / static_cast<float>(near.size() - 1));
    const Layer layer = own_layer(std::span(heights).first(offsets.size()), spacing);

    std::array<glm::vec3, kMostSampled> own;
    size_t used = 0;
    for (size_t i = 0; i < offsets.size(); ++i)
        if (layer.holds(heights[i])) own[used++] = offsets[i];
    if (used < offsets.size()) plane = fitter.fit(std::span(own).first(used));

    sample.normal = glm::vec3(plane.normal);
    sample.deviation = deviation_of(plane, used);
    if (!(sample.deviation < kPoorDeviation)) {
        // A blob has no disc, and a stray point must not get that of the empty space around it.
        sample.area = std::min(spacing * spacing, share_of_neighbours(offsets));
        return sample;
    }
    ShareCell cell = cell_of(offsets, std::span(heights).first(offsets.size()), sample.normal, layer);
    sample.area = cell.area();
    if (cell.open()) sample.rim = cell;
    return sample;
}

}  // namespace lucarne::octree
