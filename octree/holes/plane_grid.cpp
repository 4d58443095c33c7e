#include "octree/holes/plane_grid.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

namespace lucarne::octree {
namespace {

constexpr float kMargin = 3;        ///< cells around the points of a plane
constexpr float kParallel = 0.87f;  ///< cosine of 30 degrees: planes that turn less make no crease
constexpr size_t kMostGap = 8;      ///< half cells of a crease in which the other plane may be missing
/// What a station saw so far behind a place shows that the place is empty, in cells.
constexpr float kBehindCells = 1.5f;

glm::vec2 extent_of(const HolePlane& plane, float cell) {
    return (plane.most - plane.least) / cell + 2 * kMargin + 1.0f;
}

/// The part of a line p + t d in a rectangle, as a range of t.
std::optional<glm::vec2> clipped(const glm::vec2& p, const glm::vec2& d, const glm::vec2& least,
                                 const glm::vec2& most) {
    glm::vec2 range(-1e9f, 1e9f);
    for (glm::length_t axis = 0; axis < 2; ++axis) {
        if (std::abs(d[axis]) < 1e-6f) {
            if (p[axis] < least[axis] || p[axis] > most[axis]) return std::nullopt;
            continue;
        }
        const float a = (least[axis] - p[axis]) / d[axis], b = (most[axis] - p[axis]) / d[axis];
        range = {std::max(range.x, std::min(a, b)), std::min(range.y, std::max(a, b))};
    }
    if (!(range.x < range.y)) return std::nullopt;
    return range;
}

/// Whether a plane has points within `steps` cells of a place on it, to one side, and is hidden in between.
bool reaches(const PlaneGrid& grid, glm::vec2 from, const glm::vec2& step, int steps, uint64_t& work) {
    for (int i = 0; i <= steps; ++i, from += step, ++work) {
        const glm::ivec2 cell = grid.cell_of(from);
        if (!grid.inside(cell.x, cell.y)) continue;
        const PlaneCell state = grid[grid.index(cell.x, cell.y)];
        if (state == PlaneCell::surface) return true;
        if (state == PlaneCell::open) return false;
    }
    return false;
}

}  // namespace

double PlaneGrid::cells_of(const HolePlane& plane, float cell) {
    const glm::vec2 extent = extent_of(plane, cell);
    return std::ceil(double{extent.x}) * std::ceil(double{extent.y});
}

PlaneGrid::PlaneGrid(HolePlane plane, float cell) : plane_(std::move(plane)), cell_(cell) {
    const glm::vec2 extent = extent_of(plane_, cell);
    width_ = static_cast<int>(std::ceil(extent.x));
    height_ = static_cast<int>(std::ceil(extent.y));
    origin_ = plane_.least - (kMargin + 0.5f) * cell;
    cells_.assign(static_cast<size_t>(width_) * static_cast<size_t>(height_), PlaneCell::hidden);
    quarters_.assign(cells_.size(), 0);
}

glm::ivec2 PlaneGrid::cell_of(const glm::vec2& flat) const {
    const glm::vec2 cell = glm::clamp((flat - origin_) / cell_, glm::vec2(-1.0f), glm::vec2(1e8f));
    return glm::ivec2(glm::floor(cell));
}

void PlaneGrid::cover(const glm::vec3& position, float radius, float disc, PlaneCell as) {
    const glm::vec2 flat = plane_.flat(position);
    const auto enter = [&](int x, int y, bool own) {
        if (!inside(x, y)) return;
        PlaneCell& state = cells_[index(x, y)];
        if (state == PlaneCell::surface || (state == PlaneCell::bend && as == PlaneCell::bend)) return;
        if (own) {
            covered_ += !is_surface(state);
            state = as;
        } else if (!is_surface(state)) {
            state = PlaneCell::fringe;
        }
    };
    const glm::ivec2 own = cell_of(flat);
    enter(own.x, own.y, true);
    if (inside(own.x, own.y)) {
        const glm::vec2 from_middle = flat - flat_of(own);
        quarters_[index(own.x, own.y)] |=
            static_cast<uint8_t>(1 << ((from_middle.x > 0 ? 1 : 0) + (from_middle.y > 0 ? 2 : 0)));
    }
    const glm::ivec2 first = cell_of(flat - disc), last = cell_of(flat + disc);
    for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) {
            const glm::vec2 offset = flat_of({x, y}) - flat;
            const float squared = glm::dot(offset, offset);
            if (squared <= disc * disc) enter(x, y, squared <= radius * radius);
        }
}

void PlaneGrid::look(const StationViews& views) {
    if (views.empty()) return;
    for (size_t i = 0; i < cells_.size(); ++i) {
        if (cells_[i] != PlaneCell::hidden) continue;
        const Sight sight = views.at(place_of(flat_of(cell_at(i))), plane_.normal, kBehindCells * cell_);
        cells_[i] = sight == Sight::through   ? PlaneCell::open
                    : sight == Sight::surface ? PlaneCell::seen
                                              : PlaneCell::hidden;
    }
}

uint64_t mark_creases(PlaneGrid& grid, const PlaneGrid& other, float reach, uint64_t work,
                      std::vector<CreasePlane>& creases) {
    const HolePlane &plane = grid.plane(), &across = other.plane();
    const float cosine = glm::dot(plane.normal, across.normal);
    if (std::abs(cosine) > kParallel) return 1;
    const glm::vec3 apart =
        glm::max(glm::max(plane.low - across.high, across.low - plane.high), glm::vec3(0.0f));
    if (glm::dot(apart, apart) > reach * reach) return 1;
    const glm::vec3 along = glm::normalize(glm::cross(plane.normal, across.normal));
    // The point of the line nearest to the middle of the first plane.
    const glm::vec3 toward = glm::normalize(glm::cross(along, plane.normal));
    const glm::vec3 start =
        plane.centre - across.height(plane.centre) / glm::dot(toward, across.normal) * toward;
    const auto flat_direction = [](const HolePlane& in, const glm::vec3& d) {
        return glm::vec2(glm::dot(d, in.u), glm::dot(d, in.v));
    };
    const auto here = clipped(plane.flat(start), flat_direction(plane, along), plane.least - grid.cell(),
                              plane.most + grid.cell());
    const auto there =
        clipped(across.flat(start), flat_direction(across, along), across.least - reach, across.most + reach);
    if (!here || !there) return 1;
    const float first = std::max(here->x, there->x), last = std::min(here->y, there->y);
    const glm::vec2 step = other.cell() * flat_direction(across, glm::cross(along, across.normal));
    const int steps = static_cast<int>(reach / other.cell());
    uint64_t taken = 1;
    bool found = false;
    std::vector<size_t> gap;  // cells since the other plane was last found
    for (float t = first; t <= last && taken < work; t += 0.5f * grid.cell(), ++taken) {
        const glm::vec3 place = start + t * along;
        const glm::ivec2 cell = grid.cell_of(plane.flat(place));
        if (!grid.inside(cell.x, cell.y)) continue;
        const size_t index = grid.index(cell.x, cell.y);
        const glm::vec2 from = across.flat(place);
        gap.push_back(index);
        if (!reaches(other, from, step, steps, taken) && !reaches(other, from, -step, steps, taken)) continue;
        if (gap.size() > kMostGap) gap = {index};
        for (const size_t between : gap) {
            if (grid[between] != PlaneCell::hidden && grid[between] != PlaneCell::seen) continue;
            grid.set(between, PlaneCell::crease);
            found = true;
        }
        gap.clear();
    }
    if (found) creases.push_back({across.normal, across.centre});
    return taken;
}

}  // namespace lucarne::octree
