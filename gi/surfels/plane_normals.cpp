#include "gi/surfels/plane_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/shared/surfel_code.h"
#include "gi/surfels/flat_surfels.h"
#include "io/core/parallel.h"
#include "octree/normals/surface/plane.h"
#include "octree/tree/key.h"
#include "octree/tree/radix_sort.h"

namespace lucarne::gi {
namespace {

using octree::CodeIndex;

/// So many surfels are enough for a plane, and twice as many are divided further.
constexpr size_t kFew = 8;
/// Surfels lie in a plane if their root mean square distance from it is at most this share of their radius:
/// discs then cover each other.
constexpr double kThickness = 0.25;
/// Cubes with more surfels than this are divided without a look at them.
constexpr size_t kMany = 16384;

/// Surfels without a normal are more than this share of a scan whose normals are not known yet. Fewer lie on
/// no surface.
constexpr double kUnknown = 0.05;

bool has_place(const FlatSurfel& s) {
    return s.radius > 0 && std::isfinite(s.radius) && std::isfinite(s.x) && std::isfinite(s.y) &&
           std::isfinite(s.z);
}

glm::dvec3 place_of(const FlatSurfel& s) {
    return {s.x, s.y, s.z};
}

/// Surfels of one cube, in the order of their codes.
struct Cell {
    std::span<const CodeIndex> surfels;
    uint32_t level = 0;
};

/// Calls body(child) for the eight parts of a cell that hold surfels.
template <class Body>
void for_each_part(const Cell& cell, const Body& body) {
    const uint32_t shift = 3 * (octree::kMaxLevel - cell.level - 1);
    for (auto first = cell.surfels.begin(); first != cell.surfels.end();) {
        const uint64_t code = first->code >> shift;
        const auto last = std::partition_point(
            first, cell.surfels.end(), [&](const CodeIndex& item) { return item.code >> shift == code; });
        body(Cell{{first, last}, cell.level + 1});
        first = last;
    }
}

class Planes {
 public:
    explicit Planes(std::span<FlatSurfel> surfels) : surfels_(surfels) {}

    /// Sets the normals of a cell. `normal`: of the cell that it is a part of, if it is too few.
    void set(const Cell& cell, glm::vec3 normal) const {
        bool divided = cell.surfels.size() >= 2 * kFew && cell.level < octree::kMaxLevel;
        if (cell.surfels.size() >= kFew) divided = !find_plane(cell, normal) && divided;
        if (divided) return for_each_part(cell, [&](const Cell& part) { set(part, normal); });
        const uint32_t code = encode_octahedral(normal);
        for (const CodeIndex& item : cell.surfels) {
            surfels_[item.index].normal = code;
            surfels_[item.index].albedo |= kSurfelHasNormal;
        }
    }

 private:
    /// Sets the normal of the plane about the surfels. Returns whether they lie in it.
    bool find_plane(const Cell& cell, glm::vec3& normal) const {
        const glm::dvec3 origin = place_of(surfels_[cell.surfels.front().index]);
        glm::dvec3 sum(0.0), squares(0.0), products(0.0);  // products: xy, xz, yz
        double radii = 0;
        for (const CodeIndex& item : cell.surfels) {
            const FlatSurfel& surfel = surfels_[item.index];
            const glm::dvec3 p = place_of(surfel) - origin;
            sum += p;
            squares += p * p;
            products += glm::dvec3(p.x * p.y, p.x * p.z, p.y * p.z);
            radii += static_cast<double>(surfel.radius);
        }
        const auto count = static_cast<double>(cell.surfels.size());
        const glm::dvec3 mean = sum / count, own = squares / count - mean * mean,
                         mixed =
                             products / count - glm::dvec3(mean.x * mean.y, mean.x * mean.z, mean.y * mean.z);
        const octree::Moments moments{
            1,
            {},
            {static_cast<float>(own.x), static_cast<float>(own.y), static_cast<float>(own.z),
             static_cast<float>(mixed.x), static_cast<float>(mixed.y), static_cast<float>(mixed.z)}};
        const octree::Plane plane = octree::plane_of(moments);
        const glm::vec3 found(plane.normal);
        if (!std::isfinite(found.x + found.y + found.z)) return false;  // places too far apart for floats
        normal = found;
        return std::sqrt(std::max(plane.variances[0], 0.0)) <= kThickness * radii / count;
    }

    std::span<FlatSurfel> surfels_;
};

}  // namespace

bool add_plane_normals(std::span<FlatSurfel> surfels) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
    std::vector<CodeIndex> order;
    size_t all = 0;
    for (size_t i = 0; i < surfels.size(); ++i) {
        if (!has_place(surfels[i])) continue;
        ++all;
        if (surfels[i].albedo & kSurfelHasNormal) continue;
        low = glm::min(low, place_of(surfels[i]));
        high = glm::max(high, place_of(surfels[i]));
        order.push_back({0, static_cast<uint32_t>(i)});
    }
    if (static_cast<double>(order.size()) <= kUnknown * static_cast<double>(all)) return false;
    const glm::dvec3 extent = high - low;
    // No surfel lies at the end of the cube.
    const octree::Cube cube{low, 1.001 * std::max({extent.x, extent.y, extent.z, 1e-6})};
    for (CodeIndex& item : order) item.code = cube.place(place_of(surfels[item.index])).code();
    octree::sort_by_code(order, 3 * octree::kMaxLevel);
    std::vector<Cell> cells, left = {{order, 0}};
    while (!left.empty()) {
        const Cell cell = left.back();
        left.pop_back();
        if (cell.surfels.size() <= kMany || cell.level == octree::kMaxLevel)
            cells.push_back(cell);
        else
            for_each_part(cell, [&](const Cell& part) { left.push_back(part); });
    }
    const Planes planes(surfels);
    parallel_ranges(cells.size(), 1, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) planes.set(cells[i], glm::vec3(0, 0, 1));
    });
    return true;
}

bool add_normals_of_planes(std::span<Surfel> surfels) {
    const auto bare = [](const Surfel& s) { return s.normal == glm::vec3(0.0f); };
    const auto count = static_cast<double>(std::ranges::count_if(surfels, bare));
    if (count <= kUnknown * static_cast<double>(surfels.size())) return false;
    std::vector<FlatSurfel> flat;
    flat.reserve(surfels.size());
    for (const Surfel& surfel : surfels) flat.push_back(flat_disc(surfel));
    if (!add_plane_normals(std::span(flat))) return false;
    for (size_t i = 0; i < flat.size(); ++i)
        if (bare(surfels[i]) && (flat[i].albedo & kSurfelHasNormal))
            surfels[i].normal = decode_octahedral(flat[i].normal);
    return true;
}

}  // namespace lucarne::gi
