// Closes holes in planes of a scan. That a place is empty only if a station looked through it follows Curless
// and Levoy 1996, "A volumetric method for building complex models from range images", section 4; what is
// between what was seen and what is empty is not closed as they do, but along the planes around it.
#include "octree/holes/holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

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
constexpr float kCreaseReach = 2.5f;  ///< m: so far a plane is continued to a crease
constexpr uint64_t kMostSteps = uint64_t{1} << 25;
constexpr double kLeastExtent = 0.05, kMostExtent = 1e5;  ///< m, of the sample

/// Cells have one surfel instead of four if there were more than this: synthetic surfels have no levels of
/// detail, and pictures of few points, as in motion, leave them out if they are more than a quarter.
constexpr size_t kMostFine = size_t{1} << 15;
/// Stations are known if so many of the points have one: others may have been received from anywhere.
constexpr double kKnowStations = 0.95;
// What a hole's rim has to consist of, in shares of its length.
constexpr double kLeastSurface = 0.15, kLeastKnown = 0.8;
constexpr size_t kLeastCells = 4;
constexpr double kLeastHidden = 0.5;  ///< of a hole's cells
constexpr double kMostOfPlane = 0.5;  ///< a hole's area, in that of the plane's points
constexpr double kSteep = 0.35;       ///< the rim's heights over the plane, in diameters
// The same if no station is known.
constexpr double kLeastSurfaceBlind = 0.9, kMostOfPlaneBlind = 0.1;
constexpr float kFloor = 0.9f, kMostFloorHole = 2.0f, kMostHole = 0.4f;  ///< cosine; m, m
/// Round holes of floors are those below tripods. They may be larger, and end at a wall.
constexpr double kRound = 0.8;  ///< area in that of the disc around the hole; a square's is .64
constexpr double kLeastSurfaceDisc = 0.6;
constexpr float kMostDisc = 5.5f;  ///< m, diagonal of the bounds: 3.9 m wide
/// The tripod hides walls, too: so far around the middle of the floor's hole, in the radii of that hole, and
/// as high, m. Least share of the cells of a wall's hole that lie there, and of its rim that is surface.
constexpr float kTripodWidth = 1.2f, kTripodHeight = 1.3f;
constexpr double kBelowTripod = 0.95, kLeastSurfaceBelow = 0.3;
constexpr float kWall = 0.3f;          ///< |z| of a wall's normal, at most
constexpr float kBeside = 1.5f;        ///< cells: what is so near belongs to the plane
constexpr float kLookedBehind = 3.0f;  ///< m

constexpr size_t kMostRim = 64;  ///< places of the rim from which a hole's colours and heights follow

/// A place of a hole's rim.
struct RimPlace {
    glm::vec2 flat{0.0f};
    float height = 0;
    glm::vec3 normal{0.0f}, colour{0.0f};
};

/// A hole in a plane.
struct Hole {
    size_t plane = 0;
    std::vector<uint32_t> cells;    ///< of the plane's grid
    std::vector<uint32_t> creases;  ///< cells that a crease divides
    std::vector<uint32_t> shores;   ///< cells of its rim: parts of them may be empty
    std::vector<RimPlace> rim;
};

/// A round hole of a floor, below a tripod.
struct Tripod {
    size_t plane = 0;
    glm::vec3 centre{0.0f};
    float radius = 0;  ///< m
};

/// Connected hidden cells of a plane, and what is around them.
struct Component {
    std::vector<uint32_t> cells;
    bool outer = false;                        ///< reaches the rim of the grid
    size_t hidden = 0;                         ///< cells that no station can have seen
    size_t surface = 0, crease = 0, open = 0;  ///< sides of cells at the rim
    float behind =
        0;  ///< of a wall's hole below a tripod: the sign of heights on the side without the tripod
    glm::ivec2 least{0}, most{0};
};

constexpr std::array<glm::ivec2, 8> kAround = {
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};

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

/// Finds the holes of one plane.
class HoleFinder {
 public:
    HoleFinder(const PlaneGrid& grid, const Voxels& voxels, size_t plane, bool stations)
        : grid_(grid), voxels_(voxels), plane_(plane), stations_(stations) {}

    /// Finds the holes of the plane and, if no station is known, the tripods that stand on it.
    void find(std::vector<Hole>& holes, std::vector<Tripod>& tripods) {
        find_components();
        if (!stations_ && !components_.empty()) behind_ = side_behind();
        std::erase_if(components_, [&](const Component& component) { return !is_hole(component); });
        if (!stations_) drop_seen_behind();
        if (!stations_ && is_floor())
            for (const Component& component : components_)
                if (const Disc disc = disc_of(component); disc.round)
                    tripods.push_back(
                        {plane_, grid_.place_of(grid_.flat_of({0, 0}, disc.centre)), disc.radius});
        add_to(holes);
    }

    /// Finds the holes that are narrower than three cells, if stations are known: the shadows of rails and
    /// the strips behind mouldings. Wider ones are closed already.
    void find_narrow(std::vector<Hole>& holes) {
        narrow_ = true;
        find_components();
        std::erase_if(components_, [&](const Component& component) { return !is_hole(component); });
        add_to(holes);
    }

    /// Finds the holes of a wall that tripods hid from their stations.
    void find_below(const std::vector<Tripod>& tripods, std::vector<Hole>& holes) {
        if (tripods.empty() || std::abs(grid_.plane().normal.z) > kWall) return;
        find_components();
        for (Component& component : components_) {
            const auto tripod = std::ranges::find_if(
                tripods, [&](const Tripod& before) { return is_below(component, before); });
            if (tripod != tripods.end())
                component.behind = grid_.plane().height(tripod->centre) > 0 ? -1.0f : 1.0f;
        }
        std::erase_if(components_, [](const Component& component) { return component.behind == 0; });
        drop_seen_behind();
        add_to(holes);
    }

 private:
    void add_to(std::vector<Hole>& holes) {
        if (components_.empty()) return;
        enter_voxels();
        for (Component& component : components_) {
            Hole hole = hole_of(component);
            if (!hole.rim.empty() && !steep(hole, component)) holes.push_back(std::move(hole));
        }
    }

    /// Whether a hole does not end at a cell. Hidden cells beside surface bound wide holes as it does; what
    /// a station looked at without receiving points bounds no narrow one.
    bool is_open(PlaneCell state) const {
        return state == PlaneCell::open || (narrow_ && state == PlaneCell::seen);
    }
    static bool is_hidden(PlaneCell state) { return state == PlaneCell::hidden || state == PlaneCell::seen; }
    bool hidden(const glm::ivec2& cell) const {
        return grid_.inside(cell.x, cell.y) && is_hidden(state(cell));
    }
    PlaneCell state(const glm::ivec2& cell) const { return grid_[grid_.index(cell.x, cell.y)]; }

    /// Whether a hidden cell belongs to a hole. Gaps between single points have no cell without surface
    /// around. In the narrow pass each cell that is hidden from all stations counts, also beside surface.
    bool is_core(const glm::ivec2& cell) const {
        if (narrow_) return grid_.inside(cell.x, cell.y) && state(cell) == PlaneCell::hidden;
        return hidden(cell) && std::ranges::none_of(kAround, [&](const glm::ivec2& step) {
                   const glm::ivec2 next = cell + step;
                   return grid_.inside(next.x, next.y) && state(next) == PlaneCell::surface;
               });
    }

    void find_components() {
        label_.assign(static_cast<size_t>(grid_.width()) * static_cast<size_t>(grid_.height()), 0);
        for (int y = 0; y < grid_.height(); ++y)
            for (int x = 0; x < grid_.width(); ++x)
                if (label_[grid_.index(x, y)] == 0 && is_core({x, y})) grow({x, y});
    }

    void grow(const glm::ivec2& seed) {
        Component component{.least = seed, .most = seed};
        const auto add = [&](const glm::ivec2& cell) {
            const size_t index = grid_.index(cell.x, cell.y);
            label_[index] = 1;
            component.cells.push_back(static_cast<uint32_t>(index));
            component.hidden += grid_[index] == PlaneCell::hidden;
            component.least = glm::min(component.least, cell);
            component.most = glm::max(component.most, cell);
        };
        add(seed);
        for (size_t next = 0; next < component.cells.size(); ++next) {
            const glm::ivec2 from = grid_.cell_at(component.cells[next]);
            for (size_t i = 0; i < 4; ++i) {
                const glm::ivec2 to = from + kAround[i];
                if (!grid_.inside(to.x, to.y)) {
                    component.outer = true;
                } else if (is_core(to)) {
                    if (label_[grid_.index(to.x, to.y)] == 0) add(to);
                } else {
                    const PlaneCell rim = state(to);
                    ++(rim == PlaneCell::crease ? component.crease
                       : is_open(rim)           ? component.open
                                                : component.surface);
                }
            }
        }
        if (!component.outer) components_.push_back(std::move(component));
    }

    float diameter(const Component& component) const {
        return grid_.cell() *
               static_cast<float>(1 + glm::length(glm::vec2(component.most - component.least)));
    }

    /// The disc around a hole, and whether the hole is round, as below a tripod. It may end at a wall.
    struct Disc {
        glm::dvec2 centre{0.0};  ///< in cells
        float radius = 0;        ///< m
        bool round = false;
    };
    Disc disc_of(const Component& component) const {
        Disc disc;
        for (const uint32_t cell : component.cells) disc.centre += glm::dvec2(grid_.cell_at(cell));
        disc.centre /= static_cast<double>(component.cells.size());
        double farthest = 0;
        for (const uint32_t cell : component.cells)
            farthest = std::max(farthest, glm::distance(glm::dvec2(grid_.cell_at(cell)), disc.centre));
        const double around = std::numbers::pi * (farthest + 0.5) * (farthest + 0.5);
        disc.radius = grid_.cell() * static_cast<float>(farthest + 0.5);
        disc.round = static_cast<double>(component.cells.size()) >= kRound * around;
        disc.centre += 0.5;
        return disc;
    }

    /// Whether a wall's hole lies where a tripod stood before the wall.
    bool is_below(const Component& component, const Tripod& tripod) const {
        if (component.cells.size() < kLeastCells) return false;
        const auto rim = static_cast<double>(component.surface + component.crease + component.open);
        const auto surface = static_cast<double>(component.surface),
                   known = surface + static_cast<double>(component.crease);
        if (surface < kLeastSurfaceBelow * rim || known < kLeastSurfaceBlind * rim) return false;
        size_t below = 0;
        for (const uint32_t cell : component.cells) {
            const glm::vec3 apart = grid_.place_of(grid_.flat_of(grid_.cell_at(cell))) - tripod.centre;
            below += glm::length(glm::vec2(apart)) < kTripodWidth * tripod.radius &&
                     apart.z > -kBeside * grid_.cell() && apart.z < kTripodHeight;
        }
        return static_cast<double>(below) >= kBelowTripod * static_cast<double>(component.cells.size()) &&
               static_cast<double>(component.cells.size()) <=
                   kMostOfPlane * static_cast<double>(grid_.covered());
    }

    bool is_hole(const Component& component) const {
        if (component.cells.size() < kLeastCells) return false;
        const auto rim = static_cast<double>(component.surface + component.crease + component.open);
        const double surface = static_cast<double>(component.surface) / rim,
                     known = surface + static_cast<double>(component.crease) / rim,
                     share =
                         static_cast<double>(component.cells.size()) / static_cast<double>(grid_.covered());
        const double hidden =
            static_cast<double>(component.hidden) / static_cast<double>(component.cells.size());
        if (stations_)
            return surface >= kLeastSurface && known >= kLeastKnown && hidden >= kLeastHidden &&
                   share <= kMostOfPlane;
        const bool floor = is_floor();
        if (floor && disc_of(component).round)
            return surface >= kLeastSurfaceDisc && known >= kLeastSurfaceBlind && share <= kMostOfPlane &&
                   diameter(component) <= kMostDisc;
        const float most = floor ? kMostFloorHole : kMostHole;
        return surface >= kLeastSurfaceBlind && share <= kMostOfPlaneBlind && diameter(component) <= most;
    }

    bool is_floor() const { return behind_ * grid_.plane().normal.z < -kFloor; }

    /// Finds the side of the plane that nobody stood on, if no station is known: that with fewer points.
    /// Normals may face either side then. Returns 1 where the plane's normal points, else -1.
    float side_behind() const {
        ptrdiff_t before = 0, behind = 0;
        for (const Voxel& voxel : voxels_.all()) {
            const float height = grid_.plane().height(voxel.position);
            if (std::abs(height) < kBeside * grid_.cell() || std::abs(height) > kLookedBehind) continue;
            const glm::ivec2 cell = grid_.cell_of(grid_.plane().flat(voxel.position));
            if (grid_.inside(cell.x, cell.y)) ++(height > 0 ? before : behind);
        }
        return behind <= before ? -1.0f : 1.0f;
    }

    /// The sign of heights behind a component's hole; 0: either side may be the one behind.
    float behind_of(const Component& component) const {
        return component.behind != 0 ? component.behind : is_floor() ? behind_ : 0;
    }

    /// Drops holes with points behind them: what is there was seen through the hole, or is the side of a
    /// recess. A wall may have been scanned from either side, so points on both of its sides count.
    void drop_seen_behind() {
        if (components_.empty()) return;
        std::vector<uint32_t> component_of(label_.size(), UINT32_MAX);
        for (uint32_t i = 0; i < components_.size(); ++i)
            for (const uint32_t cell : components_[i].cells) component_of[cell] = i;
        std::vector<bool> seen(components_.size(), false);
        for (const Voxel& voxel : voxels_.all()) {
            const float height = grid_.plane().height(voxel.position);
            if (std::abs(height) < kBeside * grid_.cell() || std::abs(height) > kLookedBehind) continue;
            const glm::ivec2 cell = grid_.cell_of(grid_.plane().flat(voxel.position));
            for (int y = cell.y - 1; y <= cell.y + 1; ++y)
                for (int x = cell.x - 1; x <= cell.x + 1; ++x)
                    if (grid_.inside(x, y))
                        if (const uint32_t i = component_of[grid_.index(x, y)];
                            i != UINT32_MAX && behind_of(components_[i]) * height >= 0)
                            seen[i] = true;
        }
        std::vector<Component> kept;
        for (size_t i = 0; i < components_.size(); ++i)
            if (!seen[i]) kept.push_back(std::move(components_[i]));
        components_ = std::move(kept);
    }

    /// Notes which voxel of the plane is in which cell.
    void enter_voxels() {
        voxel_at_.assign(label_.size(), kNoVoxel);
        const auto all = voxels_.all();
        for (uint32_t i = 0; i < all.size(); ++i) {
            if (all[i].plane != plane_) continue;
            const glm::ivec2 cell = grid_.cell_of(grid_.plane().flat(all[i].position));
            if (grid_.inside(cell.x, cell.y)) voxel_at_[grid_.index(cell.x, cell.y)] = i;
        }
    }

    Hole hole_of(const Component& component) {
        Hole hole{.plane = plane_, .cells = component.cells, .creases = {}, .shores = {}, .rim = {}};
        std::vector<uint32_t> rim;
        const auto take = [&](uint32_t index, std::vector<uint32_t>& into) {
            if (label_[index] == 2) return;
            label_[index] = 2;  // not again for this hole
            into.push_back(index);
        };
        for (const uint32_t cell : component.cells) label_[cell] = 2;
        std::vector<uint32_t> edge;
        for (const uint32_t cell : component.cells)
            for (const glm::ivec2& step : kAround) {
                const glm::ivec2 to = grid_.cell_at(cell) + step;
                if (!grid_.inside(to.x, to.y)) continue;
                const auto index = static_cast<uint32_t>(grid_.index(to.x, to.y));
                if (is_hidden(grid_[index]) || grid_[index] == PlaneCell::fringe) take(index, edge);
                if (grid_[index] == PlaneCell::crease) take(index, hole.creases);
            }
        for (const uint32_t cell : edge)
            for (const glm::ivec2& step : kAround) {
                const glm::ivec2 to = grid_.cell_at(cell) + step;
                if (!grid_.inside(to.x, to.y)) continue;
                const auto index = static_cast<uint32_t>(grid_.index(to.x, to.y));
                if (grid_[index] == PlaneCell::surface) take(index, rim);
            }
        hole.cells.insert(hole.cells.end(), edge.begin(), edge.end());
        for (const uint32_t cell : rim) label_[cell] = 0;
        for (const uint32_t cell : hole.creases) label_[cell] = 0;
        std::ranges::sort(rim);
        hole.shores = rim;
        const size_t step = std::max<size_t>(1, rim.size() / kMostRim);
        for (size_t i = 0; i < rim.size(); i += step) add_rim(hole, rim[i]);
        return hole;
    }

    /// Adds the mean of the voxels at a cell of the rim.
    void add_rim(Hole& hole, uint32_t index) const {
        RimPlace place;
        float count = 0;
        const glm::ivec2 cell = grid_.cell_at(index);
        for (int y = cell.y - 1; y <= cell.y + 1; ++y)
            for (int x = cell.x - 1; x <= cell.x + 1; ++x) {
                if (!grid_.inside(x, y) || voxel_at_[grid_.index(x, y)] == kNoVoxel) continue;
                const Voxel& voxel = voxels_.all()[voxel_at_[grid_.index(x, y)]];
                place.flat += grid_.plane().flat(voxel.position);
                place.height += grid_.plane().height(voxel.position);
                place.normal += voxel.normal;
                place.colour += voxel.colour;
                ++count;
            }
        if (count == 0) return;
        place.flat /= count;
        place.height /= count;
        place.colour /= count;
        hole.rim.push_back(place);
    }

    bool steep(const Hole& hole, const Component& component) const {
        const auto [low, high] = std::ranges::minmax(hole.rim, {}, &RimPlace::height);
        return high.height - low.height > kSteep * diameter(component);
    }

    const PlaneGrid& grid_;
    const Voxels& voxels_;
    const size_t plane_;
    const bool stations_;
    bool narrow_ = false;
    float behind_ = -1;  ///< the sign of heights behind the plane
    std::vector<uint8_t> label_;
    std::vector<Component> components_;
    std::vector<uint32_t> voxel_at_;
};

/// Returns the surface in a hole: the mean of its rim, weighted by 1 / distance^3 (Shepard 1968).
FillPoint interpolated(const Hole& hole, const PlaneGrid& grid, const glm::vec2& flat) {
    FillPoint point;
    float weights = 0, height = 0;
    for (const RimPlace& place : hole.rim) {
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

/// Whether a place is on the same side of all creases nearby as another.
bool same_side(const std::vector<CreasePlane>& creases, const glm::vec3& a, const glm::vec3& b, float near) {
    return std::ranges::all_of(creases, [&](const CreasePlane& crease) {
        const float here = glm::dot(a - crease.centre, crease.normal);
        return std::abs(here) > near || here * glm::dot(b - crease.centre, crease.normal) > 0;
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
        for (size_t i = 0; i < grids_.size(); ++i)
            HoleFinder(grids_[i], voxels_, i, know_stations_).find(holes, tripods);
        if (know_stations_) find_narrow(holes);
        find_below(tripods, holes);
        const auto cells = [](const Hole& hole) {
            return hole.cells.size() + hole.creases.size() + hole.shores.size();
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

    void close(const std::vector<Hole>& holes) {
        for (const Hole& hole : holes)
            for (const uint32_t cell : hole.cells) grids_[hole.plane].set(cell, PlaneCell::surface);
    }

    void find_narrow(std::vector<Hole>& holes) {
        close(holes);
        for (size_t i = 0; i < grids_.size(); ++i) HoleFinder(grids_[i], voxels_, i, true).find_narrow(holes);
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
        const glm::vec3 inside = grid.place_of(grid.flat_of(grid.cell_at(hole.cells.front())));
        // Adds the i-th of along^2 points of a cell.
        const auto add_point = [&](uint32_t cell, int i, int along, bool divided) {
            const float pitch = 1 / static_cast<float>(along);
            const glm::vec2 part(static_cast<float>(i % along) + 0.5f, static_cast<float>(i / along) + 0.5f);
            const glm::vec2 flat = grid.flat_of(grid.cell_at(cell), pitch * part);
            if (divided && !same_side(creases_[hole.plane], grid.place_of(flat), inside, cell_)) return;
            points.push_back(interpolated(hole, grid, flat));
            points.back().area = pitch * pitch * cell_ * cell_;
        };
        const auto add = [&](uint32_t cell, bool divided) {
            for (int i = 0; i < parts * parts; ++i) add_point(cell, i, parts, divided);
        };
        for (const uint32_t cell : hole.cells) add(cell, false);
        for (const uint32_t cell : hole.creases) add(cell, true);
        // The points of the sample are sparser than those of the scan, whose small discs may end earlier.
        if (!shores) return;
        for (const uint32_t cell : hole.shores)
            for (int quarter = 0; quarter < 4; ++quarter)
                if (!grid.has_point(cell, quarter)) add_point(cell, quarter, 2, true);
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
