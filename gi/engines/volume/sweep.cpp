#include "gi/engines/volume/sweep.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gi/shared/brdf.h"
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

Sweeper::Sweeper(std::span<const Space* const> spaces) {
    for (const Space* space : spaces) {
        Level& level = levels_.emplace_back(Level{*space});
        if (levels_.size() > 1) level.border.emplace(levels_[levels_.size() - 2].space, *space);
        const auto occupied = space->voxels.occupied();
        const Grid& grid = space->grid();
        for (int axis = 0; axis < 3; ++axis) {
            const PlaneShape shape(grid, axis);
            Order& order = level.orders[static_cast<size_t>(axis)];
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
}

void Sweeper::begin(Directions directions, std::span<const std::span<const glm::vec3>> radiance,
                    Outside outside) {
    directions_ = std::move(directions);
    outside_ = std::move(outside);
    for (size_t i = 0; i < levels_.size(); ++i) {
        Level& level = levels_[i];
        level.radiance.assign(level.space.voxels.occupied().size(), {});
        const auto faces = level.space.faces.all();
        for (size_t face = 0; face < faces.size(); ++face) {
            const glm::vec3& light = radiance[i][face];
            level.radiance[faces[face].voxel][static_cast<size_t>(faces[face].side)] = {
                Vector{light.x, light.y, light.z, 1}};
        }
        for (auto& sum : level.sums) sum.assign(faces.size(), Four{});
    }
    done_ = 0;
}

/// Light of one direction on its way through a space.
class Sweeper::Crossing {
 public:
    Crossing(const Level& level, const Directions& directions, const glm::vec3& way)
        : level_(level),
          shape_(level.space.grid(), largest_axis(way)),
          forward_(way[shape_.along] > 0),
          squares_(way * way) {
        // Light comes from as many cells away across the plane as it advances along it.
        const float slope = 1 / std::abs(way[shape_.along]);
        const float across_u = std::abs(way[shape_.u]) * slope, across_v = std::abs(way[shape_.v]) * slope;
        back_u_ = way[shape_.u] >= 0 ? -1 : 1;
        back_v_ = (way[shape_.v] >= 0 ? -1 : 1) * shape_.width;
        straight_ = (1 - across_u) * (1 - across_v);
        beside_ = across_u * (1 - across_v);
        over_ = (1 - across_u) * across_v;
        diagonal_ = across_u * across_v;
        for (int i = 0; i < 3; ++i) {
            const int axis = i == 0 ? shape_.along : i == 1 ? shape_.u : shape_.v;
            const auto left = static_cast<size_t>(side_of(axis, way[axis]));
            const auto met = static_cast<size_t>(opposite(static_cast<int>(left)));
            const float cosine = std::abs(way[axis]);
            ways_[static_cast<size_t>(i)] = {met, left, cosine, cosine * directions.weights[met],
                                             i == 0   ? 0
                                             : i == 1 ? back_u_
                                                      : back_v_};
        }
    }

    /// Adds the irradiance of the faces to `target`. `around`: the radiance in the cells of the border's box;
    /// without a border `outside` is all around. `inner`: whose cells are kept in `kept`.
    void cross(const Vector& outside, std::span<const Four> around, std::vector<Four>& target,
               const Border* inner, std::vector<Four>& kept) {
        before_.assign(shape_.cells(), Four{outside});
        now_ = before_;
        if (inner) kept.assign(inner->cells(), Four{});
        const int planes = level_.space.grid().size[shape_.along];
        if (level_.border) enter_first(around, forward_ ? -1 : planes);
        for (int k = 0; k < planes; ++k) {
            const int plane = forward_ ? k : planes - 1 - k;
            if (level_.border) enter_beside(around, plane);
            cross_air();
            meet_faces(plane, target);
            if (inner) keep(plane, *inner, kept);
            std::swap(before_, now_);
        }
    }

 private:
    void cross_air() {
        const float straight = straight_, beside = beside_, over = over_, diagonal = diagonal_;
        const ptrdiff_t back_u = back_u_, back_v = back_v_;
        for (int v = 1; v < shape_.height - 1; ++v) {
            const Four* p = before_.data() + static_cast<ptrdiff_t>(v) * shape_.width;
            Four* out = now_.data() + static_cast<ptrdiff_t>(v) * shape_.width;
            for (int u = 1; u < shape_.width - 1; ++u) {
                const Vector sum = straight * p[u].v + beside * p[u + back_u].v + over * p[u + back_v].v +
                                   diagonal * p[u + back_u + back_v].v;
                out[u].v = sum / std::max(sum[3], kLeastKnown);
            }
        }
    }

    /// Adds what arrives at the faces of a plane, and sets what its occupied voxels send out.
    void meet_faces(int plane, std::vector<Four>& target) {
        const Order& order = level_.orders[static_cast<size_t>(shape_.along)];
        const size_t first = order.starts[static_cast<size_t>(plane)],
                     last = order.starts[static_cast<size_t>(plane) + 1];
        for (size_t i = first; i < last; ++i) {
            const auto& numbers = level_.space.faces.numbers()[order.voxels[i]];
            for (const Way& w : ways_) {
                const uint32_t face = numbers[w.met];
                if (face == Faces::kNone) continue;
                const Four& arriving = now_[static_cast<size_t>(order.places[i] + w.neighbour)];
                target[face].v += w.weight * arriving.v;
            }
        }
        for (size_t i = first; i < last; ++i) {
            const auto& light = level_.radiance[order.voxels[i]];
            Vector sum{};
            for (const Way& w : ways_) sum += w.cosine * light[w.left].v;
            // What its openings let pass goes on.
            const float passing = glm::dot(squares_, level_.space.air.passing(order.voxels[i]));
            Vector& now = now_[order.places[i]].v;
            const Vector own = sum / std::max(sum[3], kLeastKnown);
            now = passing > 0 ? passing * now + (1 - passing) * own : own;
        }
    }

    /// Keeps the radiance in those cells of a plane that lie in the box of a border, and are air.
    void keep(int plane, const Border& inner, std::vector<Four>& kept) const {
        const glm::ivec3 low = inner.low(), high = low + inner.size();
        if (plane < low[shape_.along] || plane >= high[shape_.along]) return;
        glm::ivec3 cell;
        cell[shape_.along] = plane;
        for (cell[shape_.v] = low[shape_.v]; cell[shape_.v] < high[shape_.v]; ++cell[shape_.v])
            for (cell[shape_.u] = low[shape_.u]; cell[shape_.u] < high[shape_.u]; ++cell[shape_.u])
                if (level_.space.voxels.is_air(cell)) kept[inner.number(cell)] = now_[shape_.place(cell)];
    }

    /// Returns the radiance that enters at a place of the border, interpolated between the cells of air.
    Four entering(const Border::Place& place, std::span<const Four> around) const {
        if (place.first == Border::kUnknown) return {};
        const glm::ivec3& size = level_.border->size();
        const size_t up_y = static_cast<size_t>(size.x), up_z = up_y * static_cast<size_t>(size.y);
        const glm::vec3 up = place.shares, down = 1.0f - up;
        Vector sum{};
        for (size_t k = 0; k < 8; ++k) {
            const bool x = (k & 1) != 0, y = (k & 2) != 0, z = (k & 4) != 0;
            const float weight = (x ? up.x : down.x) * (y ? up.y : down.y) * (z ? up.z : down.z);
            sum += weight * around[place.first + (x ? 1 : 0) + (y ? up_y : 0) + (z ? up_z : 0)].v;
        }
        return {sum / std::max(sum[3], kLeastKnown)};
    }

    /// Sets the radiance in the plane before the first one.
    void enter_first(std::span<const Four> around, int plane) {
        const int side = 2 * shape_.along + (forward_ ? 1 : 0);
        glm::ivec3 cell;
        cell[shape_.along] = plane;
        for (cell[shape_.v] = -1; cell[shape_.v] < shape_.height - 1; ++cell[shape_.v])
            for (cell[shape_.u] = -1; cell[shape_.u] < shape_.width - 1; ++cell[shape_.u])
                before_[shape_.place(cell)] = entering(level_.border->at(side, cell), around);
    }

    /// Sets the radiance beside a plane, on the sides from which light comes.
    void enter_beside(std::span<const Four> around, int plane) {
        glm::ivec3 cell;
        cell[shape_.along] = plane;
        const auto enter = [&](int across, int along, int cells, bool from_low) {
            const int side = 2 * across + (from_low ? 1 : 0);
            cell[across] = from_low ? -1 : level_.space.grid().size[across];
            for (cell[along] = -1; cell[along] <= cells; ++cell[along])
                now_[shape_.place(cell)] = entering(level_.border->at(side, cell), around);
        };
        enter(shape_.u, shape_.v, level_.space.grid().size[shape_.v], back_u_ < 0);
        enter(shape_.v, shape_.u, level_.space.grid().size[shape_.u], back_v_ < 0);
    }

    const Level& level_;
    const PlaneShape shape_;
    const bool forward_;
    const glm::vec3 squares_;  ///< of the way's components: how much what each axis lets pass counts
    ptrdiff_t back_u_ = 0, back_v_ = 0;
    float straight_ = 0, beside_ = 0, over_ = 0, diagonal_ = 0;  ///< shares of the four cells before one
    /// A side that light meets and that by which it leaves, with their places beside a voxel.
    struct Way {
        size_t met, left;
        float cosine, weight;
        ptrdiff_t neighbour;  ///< where what arrives is read
    };
    std::array<Way, 3> ways_{};
    std::vector<Four> before_, now_;  ///< planes
};

bool Sweeper::advance() {
    const size_t all = directions_.ways.size(), each = (all + kGroups - 1) / kGroups;
    if (done_ >= each || levels_.front().space.grid().cells() == 0) return false;
    parallel_ranges(kGroups, 1, [&](size_t group, size_t) {
        const size_t number = group * each + done_;
        if (number >= all) return;
        const glm::vec3 way = directions_.ways[number], light = outside_(way);
        std::vector<Four> around, kept;
        for (size_t i = 0; i < levels_.size(); ++i) {
            const bool last = i + 1 == levels_.size();
            Crossing(levels_[i], directions_, way)
                .cross(Vector{light.x, light.y, light.z, 1}, around, levels_[i].sums[group],
                       last ? nullptr : &*levels_[i + 1].border, kept);
            std::swap(around, kept);
        }
    });
    return ++done_ < each;
}

std::vector<glm::vec3> Sweeper::irradiance(size_t space) const {
    const Level& level = levels_[space];
    std::vector<glm::vec3> found(level.space.faces.all().size(), glm::vec3(0.0f));
    for (size_t face = 0; face < found.size(); ++face) {
        Vector sum{};
        for (const auto& own : level.sums) sum += own[face].v;
        found[face] = glm::vec3(sum[0], sum[1], sum[2]);
        // Where nothing is known of what comes from some directions, the others count for them.
        if (level.border && sum[3] > 0) found[face] *= kPi / sum[3];
    }
    return found;
}

}  // namespace lucarne::gi::volume
