#include "gi/tree/division.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <glm/common.hpp>

#include "gi/shared/brdf.h"
#include "gi/shared/edge.h"
#include "gi/shared/surfel.h"
#include "gi/shared/surfel_code.h"
#include "gi/tree/coverage.h"
#include "octree/tree/footprint.h"

namespace lucarne::gi {
namespace {

constexpr size_t kChildren = 8;
/// Ranges of so many surfels become nodes that are full but one.
constexpr size_t kFewSurfels = kChildren * kChildren;

bool has_disc(const FlatSurfel& s) {
    return s.radius > 0 && std::isfinite(s.radius) && (s.albedo & kSurfelHasNormal) != 0 &&
           std::isfinite(s.x) && std::isfinite(s.y) && std::isfinite(s.z);
}

/// Returns which side of a cube a normal is nearest to: 0 to 5.
uint32_t side_of(const glm::vec3& n) {
    const int axis = largest_axis(n);
    return static_cast<uint32_t>(2 * axis + (n[axis] < 0));
}

/// A part and the bounds of its positions.
struct Part {
    Range range;
    int axis = 0;  ///< along which it is longest
    float low = 0, length = 0;
    /// Parts of the highest rank are divided first.
    std::tuple<bool, float, size_t> rank() const {
        return {range.count() > kChildren, length, range.count()};
    }
};

Part part_of(std::span<const PlacedSurfel> surfels, const Range& range) {
    glm::vec3 low = surfels[range.first].position, high = low;
    for (const PlacedSurfel& s : surfels.subspan(range.first, range.count())) {
        low = glm::min(low, s.position);
        high = glm::max(high, s.position);
    }
    const glm::vec3 size = high - low;
    const int axis = largest_axis(size);
    return {range, axis, low[axis], size[axis]};
}

/// Puts the surfels of a part on the two sides of a cut across its length; returns the first of the second.
size_t cut(std::span<PlacedSurfel> surfels, const Part& part, bool few, bool median) {
    const auto begin = surfels.begin() + static_cast<std::ptrdiff_t>(part.range.first);
    const auto end = surfels.begin() + static_cast<std::ptrdiff_t>(part.range.last);
    const size_t count = part.range.count();
    if (!few && !median) {
        const float middle = part.low + 0.5f * part.length;
        const auto cut =
            std::partition(begin, end, [&](const PlacedSurfel& s) { return s.position[part.axis] < middle; });
        const auto before = static_cast<size_t>(cut - begin);
        if (before > 0 && before < count) return part.range.first + before;
    }
    const size_t before = few ? (count / kChildren + 1) / 2 * kChildren : count / 2;
    std::nth_element(begin, begin + static_cast<std::ptrdiff_t>(before), end,
                     [&](const PlacedSurfel& a, const PlacedSurfel& b) {
                         return std::tuple(a.position[part.axis], a.index) <
                                std::tuple(b.position[part.axis], b.index);
                     });
    return part.range.first + before;
}

}  // namespace

std::vector<PlacedSurfel> place_surfels(std::span<const FlatSurfel> surfels) {
    std::vector<PlacedSurfel> placed;
    for (size_t i = 0; i < surfels.size(); ++i) {
        const FlatSurfel& s = surfels[i];
        if (!has_disc(s)) continue;
        const glm::vec3 normal = decode_octahedral(s.normal);
        const float area = s.area > 0 && std::isfinite(s.area) ? s.area : kPi * s.radius * s.radius;
        float radius = s.radius;
        glm::vec3 edge(0.0f);
        if (s.edge_root > 0) {
            // Passes that draw discs round have a smaller one (cut.glsl); this is the one that the line cuts.
            radius = std::max(radius, octree::surfel_radius(s.edge_root * s.edge_root, 0));
            edge = edge_of_code(surfel_edge_code(s.normal, s.albedo), normal, s.edge_root);
        }
        placed.push_back(
            {{s.x, s.y, s.z}, normal, radius, area, edge, static_cast<uint32_t>(i), side_of(normal)});
    }
    std::stable_sort(placed.begin(), placed.end(),
                     [](const PlacedSurfel& a, const PlacedSurfel& b) { return a.side < b.side; });
    return placed;
}

Parts divide(std::span<PlacedSurfel> surfels, const Range& range, size_t level) {
    Parts children;
    if (range.count() <= kChildren) {
        for (size_t i = range.first; i < range.last; ++i) children.add({i, i + 1});
        return children;
    }
    std::vector<Part> parts;
    for (size_t first = range.first; first < range.last;) {
        const auto rest = surfels.subspan(first, range.last - first);
        const auto end = std::partition_point(
            rest.begin(), rest.end(), [&](const PlacedSurfel& s) { return s.side == surfels[first].side; });
        const size_t last = first + static_cast<size_t>(end - rest.begin());
        parts.push_back(part_of(surfels, {first, last}));
        first = last;
    }
    const bool few = range.count() <= kFewSurfels && parts.size() == 1;
    while (parts.size() < kChildren) {
        const auto longest = std::max_element(
            parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.rank() < b.rank(); });
        if (longest->range.count() <= kChildren) break;
        const Range whole = longest->range;
        const size_t at = cut(surfels, *longest, few, level >= kMedianLevel);
        *longest = part_of(surfels, {whole.first, at});
        parts.insert(longest + 1, part_of(surfels, {at, whole.last}));
    }
    for (const Part& part : parts) children.add(part.range);
    return children;
}

}  // namespace lucarne::gi
