#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/paths/cosine_rays.h"
#include "gi/engines/paths/sides.h"
#include "gi/engines/paths/surfaces.h"

namespace lucarne::gi::paths {

/// The plane in which a leaf lies, in few bytes.
struct LeafPlane {
    std::array<uint16_t, 3> centre{};  ///< in Groups::corner and edge
    uint16_t normal = 0;               ///< an octahedral code of 8 bits along each axis
    bool operator==(const LeafPlane&) const = default;
};

/// The plane in which a group lies: its mean place and unit normal.
struct GroupPlane {
    glm::vec3 centre{0.0f}, normal{0.0f, 0.0f, 1.0f};
};

/// The hierarchical volumetric data structure of Yue et al. 2007, section 5.3: sides of surfels, grouped by
/// the cells of an adaptive octree. A group is what one cell holds of one surface: sides that face the same
/// of six directions, lie in one plane (sheets that are farther apart than their discs are wide are
/// separate), see each other and see the same air. So light does not pass from one side of a wall to the
/// other. Groups of larger cells join those of smaller ones.
struct Groups {
    uint32_t leaves = 0;               ///< the first groups are those of the finest cells
    std::vector<uint32_t> leaf_of;     ///< of each side
    std::vector<uint32_t> parent;      ///< of each group; kNone: it has none
    std::vector<float> area, cell;     ///< of each group: m^2; edge of its cell, m
    std::vector<uint32_t> first;       ///< of each larger group: of its children; and their end
    std::vector<uint32_t> children;    ///< of larger groups, in their order
    std::vector<uint32_t> level_ends;  ///< ends of the larger groups of each cell size, smallest first
    std::vector<LeafPlane> planes;     ///< of leaves
    glm::vec3 corner{0.0f};            ///< of the cube that holds all, and its edge, m
    float edge = 0;

    uint32_t count() const { return static_cast<uint32_t>(parent.size()); }
    /// The groups that a larger one joins.
    std::span<const uint32_t> children_of(uint32_t group) const {
        const uint32_t begin = first[group - leaves], end = first[group - leaves + 1];
        return std::span(children).subspan(begin, end - begin);
    }
    /// Returns the largest group about this leaf whose cell fits into a ray of this width, m; the leaf
    /// itself if none does.
    uint32_t fitting(uint32_t leaf, float width) const;
    /// Returns the planes of all groups: those of larger ones are means by area.
    std::vector<GroupPlane> find_planes() const;
    bool operator==(const Groups&) const = default;
};

/// Makes groups in two passes: leaves first, whose rays tell which of them see the same air.
class GroupBuilder {
 public:
    /// `surfaces` must outlive it.
    GroupBuilder(const Surfaces& surfaces, std::span<const RayHit> hits, float least_cell);
    /// Divides some more cells until they fit into the narrowest ray that ends in them, or are about
    /// `least_cell`, m. Returns whether any are left; there are all leaves once none is.
    bool divide();

    uint32_t leaves() const { return static_cast<uint32_t>(facts_.size()); }
    std::span<const uint32_t> leaf_of() const { return leaf_of_; }
    /// Returns the sides of a leaf, in an order along a curve through space.
    std::span<const Side> sides_of(uint32_t leaf) const {
        return std::span(sides_).subspan(starts_[leaf], starts_[leaf + 1] - starts_[leaf]);
    }
    /// Notes that a ray between two leaves met nothing, so both see the same air.
    void connect(uint32_t leaf, uint32_t other);
    /// Joins some more leaves to larger groups. Returns whether any are left.
    bool join();
    /// Returns the groups once all are joined.
    Groups take();

 private:
    /// What decides which groups are joined.
    struct Facts {
        glm::vec3 normal{0.0f};  ///< sum, weighted by area
        glm::vec3 centre{0.0f};  ///< mean, weighted likewise
        float weight = 0;        ///< sum of areas, m^2, never 0
        float area = 0;          ///< m^2
        float radius = 0;        ///< m, the largest
        RayStart middle;         ///< the side nearest to the centre
        uint32_t facing = 0;
        uint32_t air = 0;
    };
    /// A cell of the octree.
    struct Cell {
        size_t first = 0, last = 0;  ///< in order_
        uint32_t first_part = 0,
                 last_part = 0;  ///< its children, cells of the next level; none: its leaves follow
        uint32_t first_leaf = 0, last_leaf = 0;
    };
    /// What has been joined so far: cells from the finest level to the root.
    struct Joining {
        Groups groups;
        std::vector<Facts> facts;                         ///< of the groups
        size_t level = 0, cell = 0;                       ///< the levels above and the cells before are left
        std::vector<std::vector<uint32_t>> finer, found;  ///< of each cell of the next level, of this: groups
    };
    void find_wanted(std::span<const RayHit> hits, float least_cell);
    bool is_divided(const Cell& cell) const;
    void begin_joining();
    LeafPlane plane_of(const Facts& facts) const;
    size_t join_cell(const Cell& cell, float edge, std::vector<uint32_t>& found);
    bool is_there(Side side) const;
    float area_of(Side side) const;
    void make_leaves(Cell& cell);
    void add_leaf(std::span<const Side> sides, uint32_t facing);
    std::vector<uint32_t> find_airs() const;
    std::vector<std::vector<Side>> divided_by_walls(std::span<const Side> sheet) const;
    bool on_one_surface(const Facts& one, const Facts& other) const;
    static void add(Facts& sum, const Facts& more);

    const Surfaces& surfaces_;
    SideSurfels surfels_;
    glm::vec3 corner_{0.0f};  ///< of the octree, and its edge, m
    float edge_ = 0;
    std::vector<uint32_t> order_;            ///< surfels along a curve through space
    std::vector<uint64_t> codes_;            ///< of these surfels: where they are on that curve
    std::vector<uint8_t> wanted_;            ///< of each surfel: the level whose cells fit into its rays
    std::vector<std::vector<Cell>> levels_;  ///< from the root
    size_t level_ = 0, cell_ = 0;            ///< the next cell to divide
    std::vector<Cell> finer_;                ///< parts of the cells of its level so far
    std::vector<Facts> facts_;               ///< of leaves
    std::vector<uint32_t> leaf_of_;
    std::vector<bool> is_met_;  ///< of each part of a disc: whether a ray meets it
    std::vector<Side> sides_;   ///< of leaves, in their order
    std::vector<uint32_t> starts_{0};
    std::vector<uint32_t> airs_;  ///< of leaves: the next one of a tree, which ends at its root
    std::unique_ptr<Joining> joining_;
};

}  // namespace lucarne::gi::paths
