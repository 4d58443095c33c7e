#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "octree/holes/plane_grid.h"
#include "octree/holes/voxels.h"

namespace lucarne::octree {

/// A place of a hole's rim.
struct HoleRimPlace {
    glm::vec2 flat{0.0f};
    float height = 0;
    glm::vec3 normal{0.0f}, colour{0.0f};
    bool bent = false;  ///< the surface bends away from the plane here
};

/// A cell of a hole's rim, and which quarters of it are beside the hole, as bits.
struct Shore {
    uint32_t cell = 0;
    uint8_t quarters = 0;
};

/// A hole in a plane.
struct Hole {
    size_t plane = 0;
    std::vector<uint32_t> cells;    ///< of the plane's grid
    std::vector<uint32_t> edges;    ///< hidden cells beside these; they may be beyond a crease
    std::vector<uint32_t> creases;  ///< cells that a crease divides
    std::vector<Shore> shores;      ///< cells of its rim: parts of them may be empty
    std::vector<HoleRimPlace> rim;
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
    /// Of a wall's hole below a tripod: the sign of heights on the side without the tripod.
    float behind = 0;
    glm::ivec2 least{0}, most{0};
};

/// Finds the holes of one plane.
class HoleFinder {
 public:
    /// `leak`: a hole may be connected with the outside of the plane by gaps of up to twice so many cells in
    /// what bounds it.
    HoleFinder(const PlaneGrid& grid, const Voxels& voxels, size_t plane, bool stations, int leak = 0)
        : grid_(grid), voxels_(voxels), plane_(plane), stations_(stations), leak_(leak) {}

    /// Finds the holes of the plane and, if no station is known, the tripods that stand on it.
    void find(std::vector<Hole>& holes, std::vector<Tripod>& tripods);

    /// Finds the holes that are narrower than three cells, if stations are known: the shadows of rails and
    /// the strips behind mouldings. Wider ones are closed already.
    void find_narrow(std::vector<Hole>& holes);

    /// Finds the holes of a wall that tripods hid from their stations.
    void find_below(const std::vector<Tripod>& tripods, std::vector<Hole>& holes);

 private:
    void add_to(std::vector<Hole>& holes);

    /// Whether a hole does not end at a cell. Hidden cells beside surface bound wide holes as it does; what
    /// a station looked at without receiving points bounds no narrow one.
    bool is_open(PlaneCell state) const {
        return state == PlaneCell::open || (narrow_ && state == PlaneCell::seen);
    }
    /// Whether surface or a crease is at a cell.
    static bool bounds(PlaneCell state) {
        return is_surface(state) || state == PlaneCell::fringe || state == PlaneCell::crease;
    }
    static bool is_hidden(PlaneCell state) { return state == PlaneCell::hidden || state == PlaneCell::seen; }
    bool hidden(const glm::ivec2& cell) const {
        return grid_.inside(cell.x, cell.y) && is_hidden(state(cell));
    }
    PlaneCell state(const glm::ivec2& cell) const { return grid_[grid_.index(cell.x, cell.y)]; }

    /// Whether a hidden cell belongs to a hole. Gaps between single points have no cell without surface
    /// around. In the narrow pass each cell that is hidden from all stations counts, also beside surface.
    bool is_core(const glm::ivec2& cell) const;

    /// Finds the hidden cells to which a square of 2 leak + 1 cells leads from the rim of the grid without
    /// touching the plane's surface or a crease. Returns false if there is nothing to find, or if it would
    /// take too much memory.
    bool find_outside();
    void find_components();
    void grow(const glm::ivec2& seed);

    float diameter(const Component& component) const;  ///< m

    /// The disc around a hole, and whether the hole is round, as below a tripod. It may end at a wall.
    struct Disc {
        glm::dvec2 centre{0.0};  ///< in cells
        float radius = 0;        ///< m
        bool round = false;
    };
    Disc disc_of(const Component& component) const;

    /// Whether a wall's hole lies where a tripod stood before the wall.
    bool is_below(const Component& component, const Tripod& tripod) const;

    bool is_hole(const Component& component) const;
    bool is_floor() const;

    /// Finds the side of the plane that nobody stood on, if no station is known: that with fewer points.
    /// Normals may face either side then. Returns 1 where the plane's normal points, else -1.
    float side_behind() const;

    /// The sign of heights behind a component's hole; 0: either side may be the one behind.
    float behind_of(const Component& component) const {
        return component.behind != 0 ? component.behind : is_floor() ? behind_ : 0;
    }

    /// Drops holes with points behind them: what is there was seen through the hole, or is the side of a
    /// recess. A wall may have been scanned from either side, so points on both of its sides count.
    void drop_seen_behind();

    /// Notes which voxel of the plane is in which cell.
    void enter_voxels();

    Hole hole_of(const Component& component);
    /// Returns which quarters of a cell are beside cells of the hole that is being made.
    uint8_t quarters_beside_hole(uint32_t index) const;
    /// Adds the mean of the voxels at a cell of the rim, with the median colour of those around.
    void add_rim(Hole& hole, uint32_t index) const;
    bool steep(const Hole& hole, const Component& component) const;

    const PlaneGrid& grid_;
    const Voxels& voxels_;
    const size_t plane_;
    const bool stations_;
    const int leak_;
    bool narrow_ = false;
    float behind_ = -1;  ///< the sign of heights behind the plane
    std::vector<uint8_t> label_;
    std::vector<Component> components_;
    std::vector<uint32_t> voxel_at_;
};

}  // namespace lucarne::octree
