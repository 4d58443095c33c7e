// The vector loops of the neighbour search. Each is written once for vectors of eight floats, which every
// compiler can lower, and compiled twice: for any x86-64 (or other) processor, and for those with AVX2. Both
// versions give the same bits: nothing is contracted or reassociated.
#include "octree/normals/neighbours/tile.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#if defined(__x86_64__) && !defined(__clang__)  // clang has no such pragma
#include <immintrin.h>
#define LUCARNE_HAS_WIDE
#endif
#define LUCARNE_INLINE __attribute__((always_inline)) inline
#pragma GCC diagnostic ignored "-Wpsabi"  // vectors never cross a call

namespace lucarne::octree {
namespace {

using Lanes = float __attribute__((vector_size(4 * kLanes)));
using Doubles = double __attribute__((vector_size(8 * kLanes)));
using Words = int32_t __attribute__((vector_size(4 * kLanes)));

constexpr Words kLane{0, 1, 2, 3, 4, 5, 6, 7};

namespace plain {
#include "octree/normals/neighbours/tile_loops.inl"
}  // namespace plain

#ifdef LUCARNE_HAS_WIDE
/// For each set of eight lanes: the numbers of the lanes in it, in ascending order, four bits each.
constexpr std::array<uint32_t, 256> kPacking = [] {
    std::array<uint32_t, 256> table{};
    for (uint32_t mask = 0; mask < 256; ++mask)
        for (uint32_t lane = 0, at = 0; lane < 8; ++lane)
            if (mask >> lane & 1) table[mask] |= lane << (4 * at++);
    return table;
}();

#pragma GCC push_options
#pragma GCC target("avx2")
namespace wide {
#define LUCARNE_WIDE
#include "octree/normals/neighbours/tile_loops.inl"
#undef LUCARNE_WIDE
}  // namespace wide
#pragma GCC pop_options
#define LUCARNE_CALL(name, ...) \
    (__builtin_cpu_supports("avx2") ? wide::name(__VA_ARGS__) : plain::name(__VA_ARGS__))
#else
#define LUCARNE_CALL(name, ...) plain::name(__VA_ARGS__)
#endif

size_t padded(size_t count) {
    return (count + kLanes - 1) / kLanes * kLanes;
}

}  // namespace

void PointArrays::reserve(size_t count) {
    for (auto* axis : {&x, &y, &z}) axis->reserve(count);
}

void PointArrays::clear() {
    for (auto* axis : {&x, &y, &z}) axis->clear();
}

void PointArrays::release() {
    for (auto* axis : {&x, &y, &z}) std::vector<double>().swap(*axis);
}

void Tile::clear(const glm::dvec3& new_origin) {
    origin = new_origin;
    count = 0;
}

void Tile::make_room(size_t more) {
    const size_t needed = count + more + 2 * kLanes;
    if (index.size() >= needed) return;
    for (auto* axis : {&x, &y, &z}) axis->resize(2 * needed);
    index.resize(2 * needed);
}

void Tile::pad() {
    make_room(kLanes);
    for (auto* axis : {&x, &y, &z}) std::fill_n(axis->begin() + static_cast<ptrdiff_t>(count), kLanes, 0.0f);
}

void Tile::append(const PointArrays& points, size_t first, size_t last, uint32_t offset, const glm::vec3& low,
                  const glm::vec3& high, float limit2) {
    make_room(last - first);
    LUCARNE_CALL(append, *this, points, first, last, offset, low, high, limit2);
}

void Patch::make_room(size_t points) {
    const size_t needed = points + 2 * kLanes;
    if (index.size() >= needed) return;
    for (auto* values : {&x, &y, &z, &distance2}) values->resize(2 * needed);
    index.resize(2 * needed);
}

void Patch::push_back(const glm::vec3& offset, uint32_t point) {
    x[count] = offset.x;
    y[count] = offset.y;
    z[count] = offset.z;
    distance2[count] = offset.x * offset.x + offset.y * offset.y + offset.z * offset.z;
    index[count++] = point;
}

void Patch::pad() {
    make_room(count);
    for (auto* values : {&x, &y, &z})
        std::fill_n(values->begin() + static_cast<ptrdiff_t>(count), kLanes, 0.0f);
}

void Patch::take_within(const Tile& tile, const glm::vec3& centre, float limit2) {
    make_room(tile.count);
    LUCARNE_CALL(within, *this, tile, centre, limit2);
    pad();
}

void Patch::take_nearest(Patch& from, size_t most) {
    constexpr size_t kMostRanked = 256;
    size_t candidates = from.count;
    if (candidates > std::max(kMostRanked, 2 * most)) {  // comparing all with all would take too long
        std::vector<float> sorted(from.distance2.begin(),
                                  from.distance2.begin() + static_cast<ptrdiff_t>(candidates));
        const auto last = sorted.begin() + static_cast<ptrdiff_t>(most - 1);
        std::nth_element(sorted.begin(), last, sorted.end());
        const float limit = *last;
        size_t kept = 0, at_limit = 0;
        for (size_t i = 0; i < candidates; ++i) at_limit += from.distance2[i] < limit;
        at_limit = most - at_limit;
        for (size_t i = 0; i < candidates; ++i) {
            const float d2 = from.distance2[i];
            if (d2 > limit || (d2 == limit && at_limit == 0)) continue;
            at_limit -= d2 == limit;
            from.x[kept] = from.x[i];
            from.y[kept] = from.y[i];
            from.z[kept] = from.z[i];
            from.distance2[kept] = d2;
            from.index[kept++] = from.index[i];
        }
        candidates = from.count = kept;
    }
    std::array<int32_t, 2 * kMostRanked + kLanes> ranks;
    LUCARNE_CALL(rank, from.distance2.data(), candidates, ranks.data());
    make_room(most);
    for (size_t i = 0; i < candidates; ++i) {
        const size_t at = std::min(static_cast<size_t>(ranks[i]), most);  // all others go behind the last
        x[at] = from.x[i];
        y[at] = from.y[i];
        z[at] = from.z[i];
        distance2[at] = from.distance2[i];
        index[at] = from.index[i];
    }
    count = std::min(candidates, most);
    pad();
}

Moments moments_of(const Patch& patch) {
    return LUCARNE_CALL(moments, patch);
}

Moments moments_of_slab(const Patch& patch, const Slab& slab, bool others) {
    return LUCARNE_CALL(slab_moments, patch, slab, others);
}

size_t count_in_slab(const Patch& patch, const Slab& slab) {
    return LUCARNE_CALL(slab_count, patch, slab);
}

std::array<int32_t, kLanes> counts_near(const Patch& patch, size_t first, size_t step, float limit2) {
    return LUCARNE_CALL(near_counts, patch, first, step, limit2);
}

void second_nearest(const Patch& patch, std::vector<float>& distance2) {
    distance2.resize(padded(patch.count));
    LUCARNE_CALL(second_least, patch, distance2.data());
    distance2.resize(patch.count - 1);
}

SectorRun flattest_run(const Patch& patch, const TangentFrame& frame, size_t least) {
    return LUCARNE_CALL(flattest, patch, frame, least);
}

Range heights_over(const Patch& patch, const glm::vec3& normal, std::vector<float>& heights) {
    heights.resize(std::max(heights.size(), padded(patch.count)));
    return LUCARNE_CALL(heights, patch, normal, heights.data());
}

Gap gap_at(const std::vector<float>& heights, size_t count, const Range& range, float middle) {
    return LUCARNE_CALL(gap, heights.data(), count, range, middle);
}

const Directions& directions() {
    static const Directions table = [] {
        Directions d;
        for (size_t i = 0; i < kDirections; ++i) {
            const double angle = 2 * std::numbers::pi * (static_cast<double>(i) + 0.2113) / kDirections;
            d.x[i] = static_cast<float>(std::cos(angle));
            d.y[i] = static_cast<float>(std::sin(angle));
        }
        return d;
    }();
    return table;
}

size_t cut_by_layer(const Patch& patch, const std::vector<float>& heights, const Range& layer,
                    const TangentFrame& frame, float coincident2, bool others, Nearness& nearness) {
    return LUCARNE_CALL(cut_layer, patch, heights.data(), layer, frame, coincident2, others, nearness);
}

size_t cut_by_slope(const Tile& tile, const Slope& slope, const TangentFrame& frame, float beyond2,
                    Nearness& nearness) {
    return LUCARNE_CALL(cut_slope, tile, slope, frame, beyond2, nearness);
}

std::array<size_t, 4> nearest_by_quarter(const Patch& patch, const TangentFrame& frame, float slope2) {
    return LUCARNE_CALL(nearest_in_quarters, patch, frame, slope2);
}

void distances_of(const Boxes& boxes, const glm::vec3& low, const glm::vec3& high,
                  std::array<float, kBoxes>& distance2) {
    LUCARNE_CALL(box_distances, boxes, low, high, distance2);
}

size_t children_within(const std::vector<Boxes>& level, const uint32_t* nodes, size_t count,
                       const Vicinity& vicinity, uint32_t* children) {
    return LUCARNE_CALL(near_children, level, nodes, count, vicinity, children);
}

float least_of(const Nearness& nearness) {
    return LUCARNE_CALL(least, nearness);
}

float mean_square_within(const Nearness& nearness, float radius) {
    return LUCARNE_CALL(mean_square, nearness, radius);
}

}  // namespace lucarne::octree
