#include "gi/engines/volume/sweep.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gi/tree/coverage.h"
#include "io/core/parallel.h"

namespace lucarne::gi::volume {
namespace {

/// Below this share of what a voxel takes nothing is known of it.
constexpr float kLeastKnown = 1e-6f;

/// The axes across planes, and the sizes of a plane with a border of one cell on each side.
struct PlaneShape {
    int along, u, v;
    int width, height;
    PlaneShape(const Grid& grid, int axis)
        : along(axis),
          u((axis + 1) % 3),
          v((axis + 2) % 3),
          width(grid.size[u] + 2),
          height(grid.size[v] + 2) {}
    size_t cells() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
    uint32_t place(const glm::ivec3& cell) const {
        return static_cast<uint32_t>((cell[v] + 1) * width + cell[u] + 1);
    }
};

}  // namespace

Sweeper::Sweeper(const Space& space) : space_(space) {
    const auto occupied = space.voxels.occupied();
    const Grid& grid = space.grid();
    for (int axis = 0; axis < 3; ++axis) {
        const PlaneShape shape(grid, axis);
        Order& order = orders_[static_cast<size_t>(axis)];
        order.starts.assign(static_cast<size_t>(grid.size[axis]) + 1, 0);
        for (const uint32_t number : occupied)
            ++order.starts[static_cast<size_t>(grid.cell(number)[axis]) + 1];
        for (size_t i = 1; i < order.starts.size(); ++i) order.starts[i] += order.starts[i - 1];
        std::vector<size_t> next(order.starts.begin(), order.starts.end() - 1);
        order.voxels.resize(occupied.size());
        order.places.resize(occupied.size());
        for (uint32_t voxel = 0; voxel < occupied.size(); ++voxel) {
            const glm::ivec3 cell = grid.cell(occupied[voxel]);
            const size_t at = next[static_cast<size_t>(cell[axis])]++;
            order.voxels[at] = voxel;
            order.places[at] = shape.place(cell);
        }
    }
}

void Sweeper::begin(Directions directions, std::span<const glm::vec3> radiance, Outside outside) {
    directions_ = std::move(directions);
    outside_ = std::move(outside);
    radiance_.assign(space_.voxels.occupied().size(), {});
    const auto faces = space_.faces.all();
    for (size_t face = 0; face < faces.size(); ++face) {
        const glm::vec3& light = radiance[face];
        radiance_[faces[face].voxel][static_cast<size_t>(faces[face].side)] = {
            Vector{light.x, light.y, light.z, 1}};
    }
    for (auto& sum : sums_) sum.assign(faces.size(), Four{});
    done_ = 0;
}

bool Sweeper::advance() {
    const size_t all = directions_.ways.size(), each = (all + kGroups - 1) / kGroups;
    if (done_ >= each || space_.grid().cells() == 0) return false;
    parallel_ranges(kGroups, 1, [&](size_t group, size_t) {
        const size_t way = group * each + done_;
        if (way < all) sweep(directions_.ways[way], sums_[group]);
    });
    return ++done_ < each;
}

/// Adds the irradiance by light that goes this way.
void Sweeper::sweep(const glm::vec3& way, std::vector<Four>& target) const {
    const Grid& grid = space_.grid();
    const PlaneShape shape(grid, largest_axis(way));
    const Order& order = orders_[static_cast<size_t>(shape.along)];
    const glm::vec3 from_outside = outside_(way);
    const Four outside{{from_outside.x, from_outside.y, from_outside.z, 1}};
    std::vector<Four> before(shape.cells(), outside), now(shape.cells(), outside);
    // Light comes from as many cells away across the plane as it advances along it.
    const float slope = 1 / std::abs(way[shape.along]);
    const float across_u = std::abs(way[shape.u]) * slope, across_v = std::abs(way[shape.v]) * slope;
    const ptrdiff_t back_u = way[shape.u] >= 0 ? -1 : 1, back_v = (way[shape.v] >= 0 ? -1 : 1) * shape.width;
    const float straight = (1 - across_u) * (1 - across_v), beside = across_u * (1 - across_v);
    const float over = (1 - across_u) * across_v, diagonal = across_u * across_v;
    // The sides that light meets and those by which it leaves, with their places beside a voxel.
    struct Way {
        size_t met, left;
        float cosine, weight;
        ptrdiff_t neighbour;  ///< where what arrives is read
    };
    std::array<Way, 3> ways;
    for (int i = 0; i < 3; ++i) {
        const int axis = i == 0 ? shape.along : i == 1 ? shape.u : shape.v;
        const auto left = static_cast<size_t>(side_of(axis, way[axis]));
        const auto met = static_cast<size_t>(opposite(static_cast<int>(left)));
        const float cosine = std::abs(way[axis]);
        ways[static_cast<size_t>(i)] = {met, left, cosine, cosine * directions_.weights[met],
                                        i == 0   ? 0
                                        : i == 1 ? back_u
                                                 : back_v};
    }
    const int planes = grid.size[shape.along];
    for (int k = 0; k < planes; ++k) {
        const auto plane = static_cast<size_t>(way[shape.along] > 0 ? k : planes - 1 - k);
        for (int v = 1; v < shape.height - 1; ++v) {
            const Four* p = before.data() + static_cast<ptrdiff_t>(v) * shape.width;
            Four* out = now.data() + static_cast<ptrdiff_t>(v) * shape.width;
            for (int u = 1; u < shape.width - 1; ++u) {
                const Vector sum = straight * p[u].v + beside * p[u + back_u].v + over * p[u + back_v].v +
                                   diagonal * p[u + back_u + back_v].v;
                out[u].v = sum / std::max(sum[3], kLeastKnown);
            }
        }
        const size_t first = order.starts[plane], last = order.starts[plane + 1];
        for (size_t i = first; i < last; ++i) {
            const auto& numbers = space_.faces.numbers()[order.voxels[i]];
            for (const Way& w : ways) {
                const uint32_t face = numbers[w.met];
                if (face == Faces::kNone) continue;
                const Four& arriving = now[static_cast<size_t>(order.places[i] + w.neighbour)];
                target[face].v += w.weight * arriving.v;
            }
        }
        for (size_t i = first; i < last; ++i) {
            const auto& light = radiance_[order.voxels[i]];
            Vector sum{};
            for (const Way& w : ways) sum += w.cosine * light[w.left].v;
            now[order.places[i]].v = sum / std::max(sum[3], kLeastKnown);
        }
        std::swap(before, now);
    }
}

std::vector<glm::vec3> Sweeper::irradiance() const {
    std::vector<glm::vec3> found(space_.faces.all().size(), glm::vec3(0.0f));
    for (const auto& sum : sums_)
        for (size_t face = 0; face < found.size(); ++face)
            found[face] += glm::vec3(sum[face].v[0], sum[face].v[1], sum[face].v[2]);
    return found;
}

}  // namespace lucarne::gi::volume
