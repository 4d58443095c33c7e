// Closes holes in planes of a scan. That a place is empty only if a station looked through it follows Curless
// and Levoy 1996, "A volumetric method for building complex models from range images", section 4; what is
// between what was seen and what is empty is not closed as they do, but along the planes around it.
#include "octree/holes/holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "octree/holes/bends.h"
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

/// Returns the weight of a place of the rim at a distance (Shepard 1968).
float weight_at(const glm::vec2& offset, const PlaneGrid& grid) {
    const float squared = glm::dot(offset, offset) + grid.cell() * grid.cell();
    return 1 / (squared * std::sqrt(squared));
}

/// Returns the surface in a hole: the mean of its rim, weighted by 1 / distance^3.
FillPoint interpolated(const Hole& hole, const PlaneGrid& grid, const glm::vec2& flat) {
    FillPoint point;
    float weights = 0, height = 0;
    for (const HoleRimPlace& place : hole.rim) {
        const float weight = weight_at(place.flat - flat, grid);
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

/// Whether a place of a hole is beside a bend, and not all around it are places of the rim: a bent surface
/// does not go straight on beyond its rim.
bool is_beyond_bend(const Hole& hole, const PlaneGrid& grid, const glm::vec2& flat) {
    constexpr float kHalf = std::numbers::pi_v<float>;
    std::vector<float> angles;
    angles.reserve(hole.rim.size());
    float bent = 0, flat_on = 0;
    for (const HoleRimPlace& place : hole.rim) {
        const glm::vec2 to = place.flat - flat;
        angles.push_back(std::atan2(to.y, to.x));
        (place.bent ? bent : flat_on) += weight_at(to, grid);
    }
    if (bent <= flat_on) return false;
    std::ranges::sort(angles);
    float gap = angles.front() + 2 * kHalf - angles.back();
    for (size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
    return gap >= kHalf;
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
        std::vector<HolePlane> planes = find_planes(voxels_, kMostPlanes);
        joined_ = find_bends(voxels_, planes);
        for (HolePlane& plane : planes) {
            cells += PlaneGrid::cells_of(plane, cell);
            if (!(cells < most)) break;
            grids_.emplace_back(std::move(plane), cell);
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
        for (PlaneGrid& grid : grids_)
            if (work_ < kMostSteps) work_ += mark_beyond_bends(grid, voxels_, kMostSteps - work_);
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
        if (plane != other && !joined_(plane, other) && work_ < kMostSteps)
            work_ +=
                mark_creases(grids_[plane], grids_[other], kCreaseReach, kMostSteps - work_, creases_[plane]);
    }

    void close(std::span<const Hole> holes) {
        for (const Hole& hole : holes)
            for (const auto* cells : {&hole.cells, &hole.edges})
                for (const uint32_t cell : *cells) grids_[hole.plane].set(cell, PlaneCell::surface);
    }

    /// Closes holes of one plane in those planes that are parts of the same bent surface.
    void close_in_joined(std::span<const Hole> holes) {
        for (const Hole& hole : holes)
            for (size_t j = 0; j < grids_.size(); ++j) {
                if (j == hole.plane || !joined_(hole.plane, j)) continue;
                for (const auto* cells : {&hole.cells, &hole.edges})
                    for (const uint32_t cell : *cells) close_in(grids_[j], hole, cell);
            }
    }
    void close_in(PlaneGrid& other, const Hole& hole, uint32_t cell) {
        const PlaneGrid& grid = grids_[hole.plane];
        const FillPoint point = interpolated(hole, grid, grid.flat_of(grid.cell_at(cell)));
        const glm::ivec2 at = other.cell_of(other.plane().flat(point.position));
        if (!other.inside(at.x, at.y)) return;
        const size_t index = other.index(at.x, at.y);
        if (other[index] == PlaneCell::hidden || other[index] == PlaneCell::seen)
            other.set(index, PlaneCell::bend);
    }

    /// Finds holes that `find` looks for in one plane, and closes them.
    template <class Find>
    void find_with_stations(int leak, std::vector<Hole>& holes, const Find& find) {
        const size_t known = holes.size();
        for (size_t i = 0; i < grids_.size(); ++i) {
            const size_t earlier = holes.size();
            HoleFinder finder(grids_[i], voxels_, i, true, leak);
            find(finder);
            close_in_joined(std::span(holes).subspan(earlier));
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
        // Which planes bend to each voxel.
        std::vector<std::pair<uint32_t, uint32_t>> bends;
        for (uint32_t i = 0; i < grids_.size(); ++i)
            for (const uint32_t voxel : grids_[i].plane().bend) bends.emplace_back(voxel, i);
        std::ranges::sort(bends);
        const std::vector<uint32_t> first = first_of_voxel(bends);
        for (size_t i = 0; i < sample.points.size(); ++i) {
            const uint32_t voxel = voxels_.of_point(i);
            if (voxel == kNoVoxel) continue;
            const HolePoint& point = sample.points[i];
            const float spacing = std::min(std::sqrt(point.area), kMostCovered / kDisc * cell_);
            const auto enter = [&](uint32_t plane, PlaneCell as) {
                grids_[plane].cover(point.position, kCovered * spacing, kDisc * spacing, as);
            };
            const uint32_t plane = voxels_.all()[voxel].plane;
            if (plane < grids_.size()) enter(plane, PlaneCell::surface);
            for (uint32_t at = first[voxel]; at < first[voxel + 1]; ++at)
                enter(bends[at].second, PlaneCell::bend);
        }
    }

    /// Returns where the pairs of each voxel begin, of pairs sorted by voxel.
    std::vector<uint32_t> first_of_voxel(const std::vector<std::pair<uint32_t, uint32_t>>& pairs) const {
        std::vector<uint32_t> first(voxels_.all().size() + 1, 0);
        for (const auto& pair : pairs) ++first[pair.first + 1];
        for (size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
        return first;
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
            if (is_beyond_bend(hole, grid, flat)) return;
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
    JoinedPlanes joined_{0};
    std::vector<std::vector<CreasePlane>> creases_;  ///< of each grid
    uint64_t work_ = 0;                              ///< steps of marking creases and bends
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
