#include "octree/holes/hole_finder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lucarne::octree {
namespace {

// What a hole's rim has to consist of, in shares of its length.
constexpr double kLeastSurface = 0.15, kLeastKnown = 0.8;
constexpr double kLeastKnownLeaking = 0.9;  ///< if it is connected with the outside by a gap
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

/// So many cells around a place of the rim have its colour. The outermost points often have that of what
/// hides the hole, because a photograph is not taken from just where the scanner stands, or are black.
constexpr int kColours = 3;

constexpr size_t kMostRim = 64;  ///< places of the rim from which a hole's colours and heights follow

constexpr std::array<glm::ivec2, 8> kAround = {
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};

/// What is known of a cell: nothing, that it is in a component, in a hole, in the hole that is being made or
/// beside it, or outside of the plane.
constexpr uint8_t kNoLabel = 0, kOfComponent = 1, kTaken = 2, kOfThisHole = 3, kOutside = 4;
/// Marks for the search of the outside take at most so many times the cells of the grid, and so many more.
constexpr double kMostMarks = 2, kMoreMarks = 1 << 22;

/// Marks of cells, with a margin around the plane's grid; a byte for each.
class CellMarks {
 public:
    CellMarks(const PlaneGrid& grid, int margin)
        : margin_(margin),
          width_(static_cast<size_t>(grid.width() + 2 * margin)),
          height_(static_cast<size_t>(grid.height() + 2 * margin)),
          marked_(width_ * height_, 0) {}

    static double cells_of(const PlaneGrid& grid, int margin) {
        return (double(grid.width()) + 2 * margin) * (double(grid.height()) + 2 * margin);
    }

    /// Cells of the plane's grid; those of the margin are outside of it.
    uint8_t& operator[](const glm::ivec2& cell) {
        return marked_[static_cast<size_t>(cell.y + margin_) * width_ +
                       static_cast<size_t>(cell.x + margin_)];
    }
    /// Marks the squares around all marked cells.
    void spread(size_t reach) {
        for (size_t y = 0; y < height_; ++y) spread_along(y * width_, 1, width_, reach);
        for (size_t x = 0; x < width_; ++x) spread_along(x, width_, height_, reach);
    }
    /// Marks what can be reached from the margin without passing a marked cell, instead of what was marked.
    void mark_reached() {
        constexpr uint8_t kReached = 2;
        std::vector<size_t> border = {0}, next;
        marked_[0] = kReached;
        const auto enter = [&](size_t to) {
            if (marked_[to] != 0) return;
            marked_[to] = kReached;
            next.push_back(to);
        };
        for (; !border.empty(); border.swap(next), next.clear())
            for (const size_t from : border) {
                const size_t x = from % width_, y = from / width_;
                if (x > 0) enter(from - 1);
                if (x + 1 < width_) enter(from + 1);
                if (y > 0) enter(from - width_);
                if (y + 1 < height_) enter(from + width_);
            }
        for (uint8_t& mark : marked_) mark = mark == kReached;
    }

 private:
    /// Marks what is within `reach` of a marked cell of a line of `length` cells.
    void spread_along(size_t first, size_t step, size_t length, size_t reach) {
        line_.resize(length);
        for (size_t i = 0; i < length; ++i) line_[i] = marked_[first + i * step];
        size_t around = 0;  // marked cells within reach
        for (size_t i = 0; i < std::min(reach, length); ++i) around += line_[i];
        for (size_t i = 0; i < length; ++i) {
            if (i + reach < length) around += line_[i + reach];
            if (i > reach) around -= line_[i - reach - 1];
            marked_[first + i * step] = around > 0;
        }
    }

    int margin_;
    size_t width_, height_;
    std::vector<uint8_t> marked_, line_;
};

}  // namespace

void HoleFinder::find(std::vector<Hole>& holes, std::vector<Tripod>& tripods) {
    find_components();
    if (!stations_ && !components_.empty()) behind_ = side_behind();
    std::erase_if(components_, [&](const Component& component) { return !is_hole(component); });
    if (!stations_) drop_seen_behind();
    if (!stations_ && is_floor())
        for (const Component& component : components_)
            if (const Disc disc = disc_of(component); disc.round)
                tripods.push_back({plane_, grid_.place_of(grid_.flat_of({0, 0}, disc.centre)), disc.radius});
    add_to(holes);
}

void HoleFinder::find_narrow(std::vector<Hole>& holes) {
    narrow_ = true;
    find_components();
    std::erase_if(components_, [&](const Component& component) { return !is_hole(component); });
    add_to(holes);
}

void HoleFinder::find_below(const std::vector<Tripod>& tripods, std::vector<Hole>& holes) {
    if (tripods.empty() || std::abs(grid_.plane().normal.z) > kWall) return;
    find_components();
    for (Component& component : components_) {
        const auto tripod =
            std::ranges::find_if(tripods, [&](const Tripod& before) { return is_below(component, before); });
        if (tripod != tripods.end())
            component.behind = grid_.plane().height(tripod->centre) > 0 ? -1.0f : 1.0f;
    }
    std::erase_if(components_, [](const Component& component) { return component.behind == 0; });
    drop_seen_behind();
    add_to(holes);
}

void HoleFinder::add_to(std::vector<Hole>& holes) {
    if (components_.empty()) return;
    enter_voxels();
    for (Component& component : components_) {
        Hole hole = hole_of(component);
        if (!hole.rim.empty() && !steep(hole, component)) holes.push_back(std::move(hole));
    }
}

bool HoleFinder::is_core(const glm::ivec2& cell) const {
    if (narrow_) return grid_.inside(cell.x, cell.y) && state(cell) == PlaneCell::hidden;
    return hidden(cell) && std::ranges::none_of(kAround, [&](const glm::ivec2& step) {
               const glm::ivec2 next = cell + step;
               return grid_.inside(next.x, next.y) && is_surface(state(next));
           });
}

bool HoleFinder::find_outside() {
    const int margin = 2 * leak_ + 1;
    const double cells = static_cast<double>(grid_.width()) * grid_.height();
    if (CellMarks::cells_of(grid_, margin) > kMostMarks * cells + kMoreMarks) return false;
    CellMarks marks(grid_, margin);
    bool any = false;
    for (int y = 0; y < grid_.height(); ++y)
        for (int x = 0; x < grid_.width(); ++x) {
            marks[{x, y}] = bounds(state({x, y}));
            any = any || is_core({x, y});
        }
    if (!any) return false;
    marks.spread(static_cast<size_t>(leak_));
    marks.mark_reached();
    marks.spread(static_cast<size_t>(leak_));
    for (int y = 0; y < grid_.height(); ++y)
        for (int x = 0; x < grid_.width(); ++x)
            if (marks[{x, y}] && is_core({x, y})) label_[grid_.index(x, y)] = kOutside;
    return true;
}

void HoleFinder::find_components() {
    label_.assign(static_cast<size_t>(grid_.width()) * static_cast<size_t>(grid_.height()), kNoLabel);
    components_.clear();
    if (leak_ > 0 && !find_outside()) return;
    for (int y = 0; y < grid_.height(); ++y)
        for (int x = 0; x < grid_.width(); ++x)
            if (label_[grid_.index(x, y)] == kNoLabel && is_core({x, y})) grow({x, y});
}

void HoleFinder::grow(const glm::ivec2& seed) {
    Component component{.least = seed, .most = seed};
    const auto add = [&](const glm::ivec2& cell) {
        const size_t index = grid_.index(cell.x, cell.y);
        label_[index] = kOfComponent;
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
                component.outer = leak_ == 0;
                ++component.open;
            } else if (label_[grid_.index(to.x, to.y)] == kOutside) {
                ++component.open;
            } else if (is_core(to)) {
                if (label_[grid_.index(to.x, to.y)] == kNoLabel) add(to);
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

float HoleFinder::diameter(const Component& component) const {
    return grid_.cell() * static_cast<float>(1 + glm::length(glm::vec2(component.most - component.least)));
}

HoleFinder::Disc HoleFinder::disc_of(const Component& component) const {
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

bool HoleFinder::is_below(const Component& component, const Tripod& tripod) const {
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
           static_cast<double>(component.cells.size()) <= kMostOfPlane * static_cast<double>(grid_.covered());
}

bool HoleFinder::is_hole(const Component& component) const {
    const auto leak = static_cast<size_t>(2 * leak_);  // holes are larger than the gaps in what bounds them
    if (component.cells.size() < std::max(kLeastCells, leak * leak)) return false;
    const auto rim = static_cast<double>(component.surface + component.crease + component.open);
    const double surface = static_cast<double>(component.surface) / rim,
                 known = surface + static_cast<double>(component.crease) / rim,
                 share = static_cast<double>(component.cells.size()) / static_cast<double>(grid_.covered());
    const double hidden = static_cast<double>(component.hidden) / static_cast<double>(component.cells.size());
    if (stations_)
        return surface >= kLeastSurface && known >= (leak_ > 0 ? kLeastKnownLeaking : kLeastKnown) &&
               hidden >= kLeastHidden && share <= kMostOfPlane;
    const bool floor = is_floor();
    if (floor && disc_of(component).round)
        return surface >= kLeastSurfaceDisc && known >= kLeastSurfaceBlind && share <= kMostOfPlane &&
               diameter(component) <= kMostDisc;
    const float most = floor ? kMostFloorHole : kMostHole;
    return surface >= kLeastSurfaceBlind && share <= kMostOfPlaneBlind && diameter(component) <= most;
}

bool HoleFinder::is_floor() const {
    return behind_ * grid_.plane().normal.z < -kFloor;
}

float HoleFinder::side_behind() const {
    ptrdiff_t before = 0, behind = 0;
    for (const Voxel& voxel : voxels_.all()) {
        const float height = grid_.plane().height(voxel.position);
        if (std::abs(height) < kBeside * grid_.cell() || std::abs(height) > kLookedBehind) continue;
        const glm::ivec2 cell = grid_.cell_of(grid_.plane().flat(voxel.position));
        if (grid_.inside(cell.x, cell.y)) ++(height > 0 ? before : behind);
    }
    return behind <= before ? -1.0f : 1.0f;
}

void HoleFinder::drop_seen_behind() {
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

void HoleFinder::enter_voxels() {
    voxel_at_.assign(label_.size(), kNoVoxel);
    const auto all = voxels_.all();
    const auto enter = [&](uint32_t voxel) {
        const glm::ivec2 cell = grid_.cell_of(grid_.plane().flat(all[voxel].position));
        if (grid_.inside(cell.x, cell.y)) voxel_at_[grid_.index(cell.x, cell.y)] = voxel;
    };
    for (const uint32_t voxel : grid_.plane().bend) enter(voxel);
    for (uint32_t i = 0; i < all.size(); ++i)
        if (all[i].plane == plane_) enter(i);
}

Hole HoleFinder::hole_of(const Component& component) {
    Hole hole{.plane = plane_, .cells = component.cells, .edges = {}, .creases = {}, .shores = {}, .rim = {}};
    std::vector<uint32_t> rim;
    const auto take = [&](uint32_t index, std::vector<uint32_t>& into) {
        if (label_[index] >= kTaken) return;
        label_[index] = kOfThisHole;
        into.push_back(index);
    };
    for (const uint32_t cell : component.cells) label_[cell] = kOfThisHole;
    for (const uint32_t cell : component.cells)
        for (const glm::ivec2& step : kAround) {
            const glm::ivec2 to = grid_.cell_at(cell) + step;
            if (!grid_.inside(to.x, to.y)) continue;
            const auto index = static_cast<uint32_t>(grid_.index(to.x, to.y));
            if (is_hidden(grid_[index]) || grid_[index] == PlaneCell::fringe) take(index, hole.edges);
            if (is_surface(grid_[index])) take(index, rim);  // beside a narrow hole
            if (grid_[index] == PlaneCell::crease) take(index, hole.creases);
        }
    for (const uint32_t cell : hole.edges)
        for (const glm::ivec2& step : kAround) {
            const glm::ivec2 to = grid_.cell_at(cell) + step;
            if (!grid_.inside(to.x, to.y)) continue;
            const auto index = static_cast<uint32_t>(grid_.index(to.x, to.y));
            if (is_surface(grid_[index])) take(index, rim);
        }
    for (const uint32_t cell : rim) label_[cell] = kNoLabel;
    for (const uint32_t cell : hole.creases) label_[cell] = kNoLabel;
    std::ranges::sort(rim);
    for (const uint32_t cell : rim) hole.shores.push_back({cell, quarters_beside_hole(cell)});
    for (const auto* cells : {&hole.cells, &hole.edges})
        for (const uint32_t cell : *cells) label_[cell] = kTaken;
    const size_t step = std::max<size_t>(1, rim.size() / kMostRim);
    for (size_t i = 0; i < rim.size(); i += step) add_rim(hole, rim[i]);
    return hole;
}

uint8_t HoleFinder::quarters_beside_hole(uint32_t index) const {
    uint8_t quarters = 0;
    const glm::ivec2 cell = grid_.cell_at(index);
    const auto in_hole = [&](int x, int y) {
        return grid_.inside(x, y) && label_[grid_.index(x, y)] == kOfThisHole;
    };
    for (int quarter = 0; quarter < 4; ++quarter) {
        const int x = cell.x + (quarter & 1 ? 1 : -1), y = cell.y + (quarter & 2 ? 1 : -1);
        if (in_hole(x, cell.y) || in_hole(cell.x, y) || in_hole(x, y))
            quarters |= static_cast<uint8_t>(1 << quarter);
    }
    return quarters;
}

void HoleFinder::add_rim(Hole& hole, uint32_t index) const {
    HoleRimPlace place;
    float count = 0;
    const glm::ivec2 cell = grid_.cell_at(index);
    std::vector<glm::vec3> colours;
    for (int y = cell.y - kColours; y <= cell.y + kColours; ++y)
        for (int x = cell.x - kColours; x <= cell.x + kColours; ++x) {
            if (!grid_.inside(x, y) || voxel_at_[grid_.index(x, y)] == kNoVoxel) continue;
            const Voxel& voxel = voxels_.all()[voxel_at_[grid_.index(x, y)]];
            colours.push_back(voxel.colour);
            if (std::max(std::abs(x - cell.x), std::abs(y - cell.y)) > 1) continue;
            place.flat += grid_.plane().flat(voxel.position);
            place.height += grid_.plane().height(voxel.position);
            place.normal += voxel.normal;
            place.bent |= voxel.plane != plane_;
            ++count;
        }
    if (count == 0) return;
    place.flat /= count;
    place.height /= count;
    const auto middle = colours.begin() + static_cast<ptrdiff_t>(colours.size() / 2);
    std::ranges::nth_element(colours, middle, {},
                             [](const glm::vec3& colour) { return colour.x + colour.y + colour.z; });
    place.colour = *middle;
    hole.rim.push_back(place);
}

bool HoleFinder::steep(const Hole& hole, const Component& component) const {
    const auto [low, high] = std::ranges::minmax(hole.rim, {}, &HoleRimPlace::height);
    return high.height - low.height > kSteep * diameter(component);
}

}  // namespace lucarne::octree
