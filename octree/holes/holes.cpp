// Closes holes in planes of a scan. That a place is empty only if a station looked through it follows Curless
// and Levoy 1996, "A volumetric method for building complex models from range images", section 4; what is
// between what was seen and what is empty is not closed as they do, but along the planes around it.
#include "octree/holes/holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "octree/holes/hole_finder.h"
#include "octree/holes/plane_grid.h"
#include "octree/holes/planes.h"
#include "octree/holes/station_views.h"
#include "octree/holes/voxels.h"

namespace lucarne::octree {
namespace {

constexpr size_t kLeastPoints = 1000, kMostPlanes = 256;
constexpr float kCellSpacings = 2.2f;  ///< edge of a cell in spacings of the sample
/// What a point covers around it with its share and with its disc, in its own spacings; at most, in cells.
constexpr float kCovered = 0.6f, kDisc = 1.2f, kMostCovered = 6;
/// Surfels at a crease may stand so far beyond it, in the edges of their squares, to leave no gap.
constexpr float kBeyondCrease = 0.4f;
constexpr float kCreaseReach = 2.5f;  ///< m: so far a plane is continued to a crease
constexpr uint64_t kMostSteps = uint64_t{1} << 25;
constexpr double kLeastExtent = 0.05, kMostExtent = 1e5;  ///< m, of the sample

/// Cells have one surfel instead of four if there were more than this: synthetic surfels have no levels of
/// detail, and pictures of few points, as in motion, leave them out if they are more than a quarter.
constexpr size_t kMostFine = size_t{1} << 15;
/// Stations are known if so many of the points have one: others may have been received from anywhere.
constexpr double kKnowStations = 0.95;
/// What bounds a hole may have gaps of twice so many cells, first none: a shadow that is in part narrow, or a
/// crease whose other plane is missing for a while, leads to the outside of the plane.
constexpr std::array kLeaks = {0, 3, 6};

float median_spacing(const HoleSample& sample) {
    std::vector<float> areas;
    areas.reserve(sample.points.size());
    for (const HolePoint& point : sample.points)
        if (point.area > 0 && point.normal != glm::vec3(0.0f)) areas.push_back(point.area);
    if (areas.size() < kLeastPoints) return 0;
    const auto middle = areas.begin() + static_cast<ptrdiff_t>(areas.size() / 2);
    std::nth_element(areas.begin(), middle, areas.end());
    return std::sqrt(*middle);
}

/// Returns the surface in a hole: the mean of its rim, weighted by 1 / distance^3 (Shepard 1968).
FillPoint interpolated(const Hole& hole, const PlaneGrid& grid, const glm::vec2& flat) {
    FillPoint point;
    float weights = 0, height = 0;
    for (const HoleRimPlace& place : hole.rim) {
        const glm::vec2 offset = place.flat - flat;
        const float squared = glm::dot(offset, offset) + grid.cell() * grid.cell();
        const float weight = 1 / (squared * std::sqrt(squared));
        weights += weight;
        height += weight * place.height;
        point.normal += weight * place.normal;
        point.colour += weight * place.colour;
    }
    point.position = grid.place_of(flat) + height / weights * grid.plane().normal;
    point.normal = glm::normalize(point.normal);
    point.colour /= weights;
    return point;
}

/// Whether a place is on the same side of all creases within `near` as another, or `beyond` one at most, m.
bool same_side(const std::vector<CreasePlane>& creases, const glm::vec3& a, const glm::vec3& b, float near,
               float beyond) {
    return std::ranges::all_of(creases, [&](const CreasePlane& crease) {
        const float here = glm::dot(a - crease.centre, crease.normal);
        const float there = glm::dot(b - crease.centre, crease.normal);
        return std::abs(here) > near || (there > 0 ? here : -here) > -beyond;
    });
}

/// The planes of a sample, with what is needed to close their holes.
class HoleSearch {
 public:
    HoleSearch(const HoleSample& sample, const HoleLimits& limits, float cell)
        : limits_(limits), cell_(cell), voxels_(sample, cell), views_(sample, limits.memory / 4) {
        double cells = 0;
        const auto most = static_cast<double>(limits.memory / 16);
        for (const HolePlane& plane : find_planes(voxels_, kMostPlanes)) {
            cells += PlaneGrid::cells_of(plane, cell);
            if (!(cells < most)) break;
            grids_.emplace_back(plane, cell);
        }
        size_t with_station = 0;
        for (const HolePoint& point : sample.points) with_station += point.station >= 0;
        know_stations_ = !views_.empty() && static_cast<double>(with_station) >=
                                                kKnowStations * static_cast<double>(sample.points.size());
        cover(sample);
        for (PlaneGrid& grid : grids_) grid.look(views_);
        creases_.resize(grids_.size());
        for (size_t i = 0; i < grids_.size(); ++i)
            for (size_t j = 0; j < grids_.size(); ++j) mark(i, j);
    }

    FoundHoles run() {
        std::vector<Hole> holes;
        std::vector<Tripod> tripods;
        if (know_stations_) {
            for (const int leak : kLeaks)
                find_with_stations(leak, holes, [&](HoleFinder& in) { in.find(holes, tripods); });
            for (const int leak : kLeaks)
                find_with_stations(leak, holes, [&](HoleFinder& in) { in.find_narrow(holes); });
        } else {
            for (size_t i = 0; i < grids_.size(); ++i)
                HoleFinder(grids_[i], voxels_, i, false).find(holes, tripods);
            find_below(tripods, holes);
        }
        const auto cells = [](const Hole& hole) {
            return hole.cells.size() + hole.edges.size() + hole.creases.size() + hole.shores.size();
        };
        std::ranges::stable_sort(holes, std::greater<>(), cells);
        size_t all = 0, kept = 0;
        while (kept < holes.size() && all + cells(holes[kept]) <= limits_.most_points)
            all += cells(holes[kept++]);
        holes.resize(kept);
        // A shore has up to four surfels, whatever the other cells have.
        const bool shores = 4 * all <= limits_.most_points;
        const int parts = shores && 4 * all <= kMostFine ? 2 : 1;
        FoundHoles found;
        for (const Hole& hole : holes) fill(hole, parts, shores, found.points);
        for (const Tripod& tripod : tripods) found.tripods.push_back(tripod.centre);
        return found;
    }

 private:
    /// Marks the creases of one plane with another.
    void mark(size_t plane, size_t other) {
        if (plane != other && work_ < kMostSteps)
            work_ +=
                mark_creases(grids_[plane], grids_[other], kCreaseReach, kMostSteps - work_, creases_[plane]);
    }

    void close(std::span<const Hole> holes) {
        for (const Hole& hole : holes)
            for (const auto* cells : {&hole.cells, &hole.edges})
                for (const uint32_t cell : *cells) grids_[hole.plane].set(cell, PlaneCell::surface);
    }

    /// Finds holes that `find` looks for in one plane, and closes them.
    template <class Find>
    void find_with_stations(int leak, std::vector<Hole>& holes, const Find& find) {
        const size_t known = holes.size();
        for (size_t i = 0; i < grids_.size(); ++i) {
            HoleFinder finder(grids_[i], voxels_, i, true, leak);
            find(finder);
        }
        close(std::span(holes).subspan(known));
    }

    /// Finds the holes of walls below tripods. Their floors, which are closed now, bound them.
    void find_below(const std::vector<Tripod>& tripods, std::vector<Hole>& holes) {
        if (tripods.empty()) return;
        const auto has_tripod = [&](size_t plane) {
            return std::ranges::any_of(tripods, [&](const Tripod& on) { return on.plane == plane; });
        };
        close(holes);
        for (size_t i = 0; i < grids_.size(); ++i) {
            for (size_t j = 0; j < grids_.size(); ++j)
                if (has_tripod(j)) mark(i, j);
            HoleFinder(grids_[i], voxels_, i, false).find_below(tripods, holes);
        }
    }

    void cover(const HoleSample& sample) {
        for (size_t i = 0; i < sample.points.size(); ++i) {
            const uint32_t voxel = voxels_.of_point(i);
            if (voxel == kNoVoxel) continue;
            const uint32_t plane = voxels_.all()[voxel].plane;
            if (plane >= grids_.size()) continue;
            const float spacing = std::min(std::sqrt(sample.points[i].area), kMostCovered / kDisc * cell_);
            grids_[plane].cover(sample.points[i].position, kCovered * spacing, kDisc * spacing);
        }
    }

    /// Fills each cell with `parts`^2 points, and the rim's cells if `shores`.
    void fill(const Hole& hole, int parts, bool shores, std::vector<FillPoint>& points) const {
        const PlaneGrid& grid = grids_[hole.plane];
        glm::vec2 middle(0.0f);  // a single cell may lie beyond a crease that has a gap
        for (const uint32_t cell : hole.cells) middle += grid.flat_of(grid.cell_at(cell));
        const glm::vec3 inside = grid.place_of(middle / static_cast<float>(hole.cells.size()));
        // Adds the i-th of along^2 points of a cell.
        const auto add_point = [&](uint32_t cell, int i, int along, bool divided) {
            const float pitch = 1 / static_cast<float>(along);
            const glm::vec2 part(static_cast<float>(i % along) + 0.5f, static_cast<float>(i / along) + 0.5f);
            const glm::vec2 flat = grid.flat_of(grid.cell_at(cell), pitch * part);
            const float beyond = kBeyondCrease * pitch * cell_;
            if (divided && !same_side(creases_[hole.plane], grid.place_of(flat), inside, cell_, beyond))
                return;
            points.push_back(interpolated(hole, grid, flat));
            points.back().area = pitch * pitch * cell_ * cell_;
        };
        const auto add = [&](uint32_t cell, bool divided) {
            for (int i = 0; i < parts * parts; ++i) add_point(cell, i, parts, divided);
        };
        for (const uint32_t cell : hole.cells) add(cell, false);
        for (const uint32_t cell : hole.edges) add(cell, true);
        for (const uint32_t cell : hole.creases) add(cell, true);
        // The points of the sample are sparser than those of the scan, whose small discs may end earlier.
        if (!shores) return;
        for (const Shore& shore : hole.shores)
            for (int quarter = 0; quarter < 4; ++quarter)
                if (shore.quarters >> quarter & 1 && !grid.has_point(shore.cell, quarter))
                    add_point(shore.cell, quarter, 2, true);
    }

    const HoleLimits limits_;
    float cell_;
    Voxels voxels_;
    StationViews views_;
    bool know_stations_ = false;
    std::vector<PlaneGrid> grids_;
    std::vector<std::vector<CreasePlane>> creases_;  ///< of each grid
    uint64_t work_ = 0;                              ///< steps of marking creases
};

}  // namespace

FoundHoles find_holes(const HoleSample& sample, const HoleLimits& limits) {
    const float spacing = median_spacing(sample);
    glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
    for (const HolePoint& point : sample.points) {
        low = glm::min(low, point.position);
        high = glm::max(high, point.position);
    }
    const double extent = sample.points.empty() ? 0 : glm::length(glm::dvec3(high) - glm::dvec3(low));
    if (!(spacing > 0 && extent > kLeastExtent && extent < kMostExtent)) return {};
    return HoleSearch(sample, limits, kCellSpacings * spacing).run();
}

}  // namespace lucarne::octree
