#include "octree/normals/surface/surface_sample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

namespace lucarne::octree {
namespace {

constexpr size_t kLeastLayer = 6;  ///< fewer points are not a layer of their own
/// Layers are separated by a gap of this share of the neighbourhood's thickness (Gaussian noise leaves such a
/// gap among 17 points once in 2^16) and of this share of the spacing. Smaller gaps are noise, rounding or
/// registration errors of one layer.
constexpr float kLayerGap = 0.4f, kLayerSpacing = 0.5f;
/// Share of the farthest neighbour's distance above which the nearest neighbour's marks a point as isolated.
/// In a plane with 16 neighbours this happens once in 2^18 (Poisson). A point in the air sees all of a
/// surface from afar and has no share of it.
constexpr float kIsolated = 0.75f;
/// A few points in the air together (mixed pixels behind an edge) are each other's neighbours, and then there
/// is nothing up to the surrounding surfaces, whose points are much closer to each other. The test compares
/// the distance to the 8th neighbour with the neighbours' distances to their own 2nd. The ratio is about 2
/// within a surface, 3 at its edge, and 4 along the lines of the most uneven scanner.
constexpr size_t kOwnRank = 8, kTheirRank = 2;
/// An outlier has half of its neighbours denser than itself. They are asked in rounds of kLanes, and so many
/// must be denser after each round: fewer are with a chance of less than 1/200 a round. Within a surface
/// (Poisson) they are with a chance of 1/4, 1/40 and 1/800.
constexpr std::array<size_t, 3> kDenser{1, 3, 6};
// The ratio of an outlier: not one of 200,000 points of a random pattern has it.
constexpr float kSparser = 7.0f;
/// The ratio of an outlier whose neighbours have no clear plane.
constexpr float kSparserInDoubt = 5.0f;
/// A sparse point beside a dense patch belongs to the patch's surface if it lies in the patch's plane: within
/// this share of its distance, plus this many deviations of the patch's own heights.
constexpr float kInPlane = 0.03f, kInNoise = 3.0f;
/// But not higher than this share of its distance, however rough the patch is (17 degrees).
constexpr float kMostHeight = 0.3f;
constexpr size_t kCompanions = 2;
/// Coordinates are rounded in files (LAS: millimetres), so variances below this share of the largest are not
/// trusted.
constexpr double kVarianceFloor = 1e-6;

/// Returns how many of eight points of a patch, from `first` on in steps of `step`, have their kTheirRank-th
/// nearest among the neighbours nearer than the root of `limit2`. Neither the point itself, whose distance is
/// 0, nor its being near counts.
size_t count_denser(const Patch& near, size_t first, size_t step, float limit2) {
    const auto counts = counts_near(near, first, step, limit2);
    size_t denser = 0;
    for (size_t k = 0, i = first; k < counts.size() && i < near.count; ++k, i += step)
        denser += near.distance2[i] > 0 &&
                  static_cast<size_t>(counts[k]) > kTheirRank + (near.distance2[i] < limit2);
    return denser;
}

/// Whether the neighbourhood of the point is much sparser than those of its neighbours, judged by the
/// neighbours' distances among themselves (the comparison of the local outlier factor: Breunig et al. 2000).
/// Within a surface, the few neighbours that are checked first decide.
bool stands_apart(const Patch& near, float sparser) {
    if (near.count <= kOwnRank) return false;
    const float limit = near.distance2[kOwnRank] / (sparser * sparser);
    if (count_denser(near, kOwnRank, kOwnRank, limit) == 0) return false;
    size_t denser = 0;
    for (size_t i = 1; i < near.count; i += kLanes) denser += count_denser(near, i, 1, limit);
    return 2 * denser >= near.count - 1;
}

/// Returns the range of heights of the layer that contains the point itself, whose height is 0. A gap of
/// nearly half the range or more contains the middle, so it is looked for there.
Range own_layer(const std::vector<float>& heights, size_t count, const Range& range, float spacing) {
    const float thickness = range.high - range.low,
                least = std::max(kLayerGap * thickness, kLayerSpacing * spacing);
    if (thickness < least) return range;
    const float middle = (range.low + range.high) / 2;
    const Gap gap = gap_at(heights, count, range, middle);
    const bool own_is_lower = middle > 0;
    const size_t own = own_is_lower ? gap.lower : count - gap.lower;
    if (gap.above - gap.below < least || own < kLeastLayer) return range;
    return own_is_lower ? Range{range.low, gap.below} : Range{gap.above, range.high};
}

}  // namespace

float deviation_of(const Plane& plane, size_t points) {
    const double n = static_cast<double>(points);
    const double widest = plane.variances[2];
    if (!(widest > 0) || points < 4) return 10.0f;
    // The plane takes three degrees of freedom from the residuals.
    const double noise = plane.variances[0] * n / (n - 3) + kVarianceFloor * widest;
    double variance = 0;
    for (const size_t axis : {1, 2}) {
        const double gap = plane.variances[axis] - noise;
        if (!(gap > 0)) return 10.0f;
        variance += noise * plane.variances[axis] / (n * gap * gap);
    }
    return static_cast<float>(std::min(10.0, std::sqrt(variance)));
}

SurfaceFit SurfaceFitter::fit(const Patch& patch, float spacing) {
    Plane plane = plane_of(moments_of(patch));
    Range range = heights_over(patch, glm::vec3(plane.normal), heights_);
    const Range layer = own_layer(heights_, patch.count, range, spacing);
    size_t used = patch.count;
    if (layer.low > range.low || layer.high < range.high) {
        layer_.clear();
        layer_.make_room(patch.count);
        for (size_t i = 0; i < patch.count; ++i)
            if (heights_[i] >= layer.low && heights_[i] <= layer.high)
                layer_.push_back(patch.offset(i), patch.index[i]);
        layer_.pad();
        used = layer_.count;
        plane = plane_of(moments_of(layer_));
    }
    const auto& v = plane.variances;
    const double freedom = static_cast<double>(used) / (static_cast<double>(used) - 3);
    return {glm::vec3(plane.normal), deviation_of(plane, used), layer, static_cast<float>(v[0] * freedom),
            v[2] > 0 ? static_cast<float>(v[1] / v[2]) : 0.0f};
}

bool SurfaceFitter::lies_in_plane_of_others(const Patch& patch, float most_deviation) {
    layer_.clear();
    layer_.make_room(patch.count);
    for (size_t i = 1; i < patch.count; ++i) layer_.push_back(patch.offset(i), patch.index[i]);
    layer_.pad();
    const Plane plane = plane_of(moments_of(layer_));
    if (deviation_of(plane, layer_.count) > most_deviation) return false;
    double height = 0;
    for (size_t i = 0; i < layer_.count; ++i) height += glm::dot(glm::dvec3(layer_.offset(i)), plane.normal);
    height /= static_cast<double>(layer_.count);
    const double gap = std::sqrt(patch.distance2[1]);
    return std::abs(height) <=
           std::min(kInPlane * gap + kInNoise * std::sqrt(plane.variances[0]), kMostHeight * gap);
}

bool is_stray(const Patch& nearest, size_t usual, bool in_doubt) {
    const size_t near = std::min(nearest.count, usual);
    if (near <= kOwnRank) return false;
    const bool sees_from_afar = nearest.distance2[1] > kIsolated * kIsolated * nearest.distance2[near - 1];
    return sees_from_afar || stands_apart(nearest, in_doubt ? kSparserInDoubt : kSparser);
}

bool may_stand_apart(const Patch& nearest, const Patch& window) {
    if (nearest.count <= kOwnRank) return false;
    const float limit = nearest.distance2[kOwnRank] / (kSparserInDoubt * kSparserInDoubt);
    const size_t step = std::max<size_t>(1, window.count / (kLanes * kDenser.size()));
    size_t denser = 0;
    for (size_t round = 0; round < kDenser.size(); ++round) {
        // The rounds take turns, so that each is spread over the whole window.
        denser += count_denser(window, round * step, kDenser.size() * step, limit);
        if (denser < kDenser[round]) return false;
    }
    return true;
}

float share_of_neighbours(const Patch& nearest) {
    static_assert(kTheirRank == 2);
    std::vector<float> reaches;
    second_nearest(nearest, reaches);
    const auto median = reaches.begin() + static_cast<ptrdiff_t>((nearest.count - 1) / 2);
    std::nth_element(reaches.begin(), median, reaches.end());
    return std::numbers::pi_v<float> * *median / kTheirRank;
}

bool is_near_enough(const Patch& nearest, float most_apart) {
    const float limit = most_apart * most_apart * share_of_neighbours(nearest);
    // The nearest few may be outliers together with it.
    return nearest.distance2[kCompanions] < limit &&
           nearest.distance2[std::min(kOwnRank, nearest.count - 1)] < 4 * limit;
}

}  // namespace lucarne::octree
