#include "octree/holes/bends.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>

namespace lucarne::octree {
namespace {

constexpr float kSmooth = 0.966f;   ///< cosine of 15 degrees: two voxels beside each other
constexpr float kFlat = 0.95f;      ///< length of a voxel's mean normal on one smooth surface
constexpr float kStep = 0.35f;      ///< slope from one voxel to the next, over their own surface
constexpr float kMostTurn = 0.7f;   ///< cosine of 45 degrees: the surface and its plane
constexpr int kMostDepth = 12;      ///< voxels from the plane
constexpr double kMostRadius = 64;  ///< of curved planes, in voxels
/// Cosine of 75 degrees: of two planes, parts of one bent surface with a third one between them. Floors and
/// walls turn more: they have a crease also if something round touches both.
constexpr float kMostApart = 0.26f;

constexpr float kBent = 0.5f;            ///< height over the plane, in cells, from which it is bent
constexpr int kAcross = 2 * kMostDepth;  ///< cells in which a place of the surface is looked for

bool is_hidden(PlaneCell state) {
    return state == PlaneCell::hidden || state == PlaneCell::seen;
}

/// Whether the surface or a crease lies on both sides of a cell, along a row, a column or a diagonal.
bool is_between(const PlaneGrid& grid, const glm::ivec2& cell, uint64_t& steps) {
    constexpr std::array<glm::ivec2, 4> kAxes = {{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
    const auto ends = [&](const glm::ivec2& step) {
        glm::ivec2 at = cell + step;
        for (int i = 0; i < kAcross && grid.inside(at.x, at.y); ++i, at += step, ++steps) {
            const PlaneCell state = grid[grid.index(at.x, at.y)];
            if (!is_hidden(state)) return state != PlaneCell::open;
        }
        return false;
    };
    return std::ranges::any_of(kAxes, [&](const glm::ivec2& axis) { return ends(axis) && ends(-axis); });
}

/// Whether the surface goes on smoothly from one voxel to another.
bool goes_on(const Voxel& from, const Voxel& to, float size) {
    const float here = glm::length(from.normal), there = glm::length(to.normal);
    if (there < kFlat || glm::dot(from.normal, to.normal) < kSmooth * here * there) return false;
    const glm::vec3 mean = glm::normalize(from.normal + to.normal);
    return std::abs(glm::dot(to.position - from.position, mean)) <= kStep * size;
}

/// Whether a plane is a strip of a curved surface. What bends away from a flat one, such as a hose on a
/// floor, does not continue it. The curvature is the slope of the normals over the plane, by least squares.
bool is_curved(const Voxels& voxels, const std::vector<uint32_t>& members, const HolePlane& plane) {
    glm::dvec2 middle(0.0), tilt(0.0);
    for (const uint32_t member : members) {
        const Voxel& voxel = voxels.all()[member];
        middle += glm::dvec2(plane.flat(voxel.position));
        tilt += glm::dvec2(glm::dot(voxel.normal, plane.u), glm::dot(voxel.normal, plane.v));
    }
    const auto count = static_cast<double>(members.size());
    middle /= count, tilt /= count;
    // Of places, and of places with tilts.
    glm::dmat2 spread(0.0), turning(0.0);
    for (const uint32_t member : members) {
        const Voxel& voxel = voxels.all()[member];
        const glm::dvec2 at = glm::dvec2(plane.flat(voxel.position)) - middle;
        const glm::dvec2 n =
            glm::dvec2(glm::dot(voxel.normal, plane.u), glm::dot(voxel.normal, plane.v)) - tilt;
        spread += glm::outerProduct(at, at);
        turning += glm::outerProduct(n, at);
    }
    const double most = kMostRadius * double{voxels.size()};
    if (!(glm::determinant(spread) > 1e-6 * spread[0][0] * spread[1][1])) return false;
    const glm::dmat2 curvature = turning * glm::inverse(spread);
    const double square = glm::dot(curvature[0], curvature[0]) + glm::dot(curvature[1], curvature[1]);
    return square * most * most > 1;
}

/// Returns the voxels up to kMostDepth steps from a plane's own `members`. `visited`: the last plane from
/// which each voxel was reached.
std::vector<uint32_t> grown_from(const Voxels& voxels, const std::vector<uint32_t>& members,
                                 const HolePlane& plane, uint32_t index, std::vector<uint32_t>& visited) {
    const auto all = voxels.all();
    std::vector<uint32_t> bend, front = members, next;
    for (int depth = 0; depth < kMostDepth && !front.empty(); ++depth, front.swap(next), next.clear())
        for (const uint32_t from : front)
            for (int i = 0; i < 27; ++i) {
                const uint32_t to = voxels.neighbour(from, {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1});
                if (to == kNoVoxel || all[to].plane == index || visited[to] == index) continue;
                const float turn = glm::dot(all[to].normal, plane.normal);
                if (turn < kMostTurn * glm::length(all[to].normal) ||
                    !goes_on(all[from], all[to], voxels.size()))
                    continue;
                visited[to] = index;
                bend.push_back(to);
                next.push_back(to);
            }
    return bend;
}

}  // namespace

JoinedPlanes find_bends(const Voxels& voxels, std::vector<HolePlane>& planes) {
    const auto all = voxels.all();
    const size_t count = planes.size();
    std::vector<std::vector<uint32_t>> members(count);
    for (uint32_t i = 0; i < all.size(); ++i)
        if (all[i].plane < count) members[all[i].plane].push_back(i);
    std::vector<uint32_t> visited(all.size(), kNoVoxel);
    JoinedPlanes touch(count);
    for (uint32_t j = 0; j < count; ++j) {
        HolePlane& plane = planes[j];
        if (!is_curved(voxels, members[j], plane)) continue;
        plane.bend = grown_from(voxels, members[j], plane, j, visited);
        for (const uint32_t voxel : plane.bend) {
            const glm::vec2 flat = plane.flat(all[voxel].position);
            plane.least = glm::min(plane.least, flat);
            plane.most = glm::max(plane.most, flat);
            if (all[voxel].plane < count) touch.join(j, all[voxel].plane);
        }
    }
    JoinedPlanes joined = touch;
    for (size_t between = 0; between < count; ++between)
        for (size_t j = 0; j < count; ++j)
            for (size_t k = 0; touch(j, between) && k < count; ++k)
                if (touch(between, k) && glm::dot(planes[j].normal, planes[k].normal) > kMostApart)
                    joined.join(j, k);
    return joined;
}

uint64_t mark_beyond_bends(PlaneGrid& grid, const Voxels& voxels, uint64_t work) {
    uint64_t steps = 0;
    std::vector<size_t> front, next, beyond;
    std::vector<bool> visited(static_cast<size_t>(grid.width()) * static_cast<size_t>(grid.height()), false);
    for (const uint32_t voxel : grid.plane().bend) {
        const glm::vec3 at = voxels.all()[voxel].position;
        const glm::ivec2 cell = grid.cell_of(grid.plane().flat(at));
        if (std::abs(grid.plane().height(at)) > kBent * grid.cell() && grid.inside(cell.x, cell.y))
            front.push_back(grid.index(cell.x, cell.y));
    }
    for (int depth = 0; depth < kMostDepth; ++depth, front.swap(next), next.clear())
        for (const size_t from : front)
            for (const glm::ivec2& step : {glm::ivec2(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
                const glm::ivec2 to = grid.cell_at(from) + step;
                if (!grid.inside(to.x, to.y) || steps >= work) continue;
                const size_t index = grid.index(to.x, to.y);
                if (visited[index] || (!is_hidden(grid[index]) && grid[index] != PlaneCell::fringe)) continue;
                visited[index] = true, ++steps;
                next.push_back(index);
                if (is_hidden(grid[index]) && !is_between(grid, to, steps)) beyond.push_back(index);
            }
    for (const size_t index : beyond) grid.set(index, PlaneCell::open);
    return steps;
}

}  // namespace lucarne::octree
