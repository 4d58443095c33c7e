#include "octree/normals/surface/group.h"

#include <algorithm>
#include <cmath>

namespace lucarne::octree {
namespace {

/// How much wider than the group the gap around it is. In two real rooms 33 of 3.2 and 39 of 3.9 million
/// points have such a gap, all of them in the air; with 1.5 more than twice as many in the second room. In a
/// scan of a town with trees none has.
constexpr double kGapAround = 2.0;

/// Sets `distances2` to the squared distances of the points within `radius`, sorted; returns false if there
/// are more than kMostGroup.
bool take_distances(const ChunkNeighbours::Surroundings::View& view, double radius,
                    std::vector<float>& distances2) {
    const Tile& tile = view.tile;
    const auto limit2 = static_cast<float>(radius * radius);
    const auto distance2 = [&](size_t i) {
        const float x = tile.x[i] - view.centre.x, y = tile.y[i] - view.centre.y,
                    z = tile.z[i] - view.centre.z;
        return x * x + y * y + z * z;
    };
    uint32_t count = 0;  // first, without branches, because most sites have many points around them
    for (size_t i = 0; i < tile.count; ++i) count += distance2(i) <= limit2 ? 1 : 0;
    if (count > kMostGroup) return false;
    distances2.clear();
    for (size_t i = 0; i < tile.count; ++i)
        if (const float d = distance2(i); d <= limit2) distances2.push_back(d);
    std::sort(distances2.begin(), distances2.end());
    return true;
}

}  // namespace

GroupSearch find_gap(ChunkNeighbours::Surroundings& around, double reach, std::vector<float>& distances2) {
    for (double end = reach, radius = 0;;) {
        radius = kGapAround * end;
        if (!around.knows(radius)) return {false, radius};
        const auto view = around.around(radius);
        if (view.radius < radius || !take_distances(view, radius, distances2)) return {};
        end = reach;
        for (const float distance2 : distances2) {
            const double distance = std::sqrt(double{distance2});
            if (distance > kGapAround * end) break;
            end = std::max(end, distance);
        }
        if (kGapAround * end <= radius) return {around.surely_knows(radius), 0};
    }
}

}  // namespace lucarne::octree
