#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <glm/vec3.hpp>

#include "octree/normals/neighbours/tile.h"

namespace lucarne::octree {

/// A point's share of the surface: its Voronoi cell among its neighbours, in its tangent plane. The cells of
/// all points add up to the surface, whatever their pattern. A share by the number of neighbours in a ball
/// would make a sparse point beside a dense patch as small as the patch's own points, and leave a hole.
///
/// The cell is described by how far it reaches in kDirections directions. Its area is the mean over these,
/// which may be wrong by a hundredth for one cell but is right in the sum of many. The cell starts as a disc
/// as wide as the widest cell that is searched for.
class ShareCell {
 public:
    /// `reach`: distance of the farthest of the nearest `neighbours`. `seen`: the cell will be cut by all
    /// points nearer than this. widest_search() tells how far to look for more; `apart`: twice as far, for a
    /// point that is far from its neighbours.
    ShareCell(const glm::vec3& normal, float reach, size_t neighbours, float seen, bool apart = false);

    /// Cuts the cell by the neighbours in the layer low .. high, or by all (`others`), which bounds the cell
    /// where the surface turns away. All `heights` are over the plane.
    void cut(const Patch& neighbours, const std::vector<float>& heights, const Range& layer,
             bool others = false);
    /// Cuts the cell along a line: where its plane meets the plane normal . x = offset (x relative to the
    /// point), which is another side of a crease.
    void cut_at(const glm::vec3& normal, float offset);
    /// Cuts the cell, where it is open, by everything that continues the surface: the points of `around`
    /// within `radius` of the site, which is at `centre` there. Returns the nearest of them beyond the reach,
    /// or the tile's count.
    size_t cut_open(const Tile& around, const glm::vec3& centre, float radius);
    /// Whether neighbours beyond the reach may still cut off much, because nothing is known on some side.
    bool open() const;
    float widest_search() const { return widest_search_; }
    float widest_cut() const;  ///< neighbours at this distance or more cannot cut the cell further
    bool closed() const;       ///< there are neighbours on all sides
    /// Returns the middle of the directions in which the cell reaches over a rim; nothing if they are on all
    /// sides. Unit, in the plane.
    std::optional<glm::vec3> outward() const;
    /// The area of a cell that is not open, divided by the points that share it.
    float area() const;
    /// The area of an open cell that no further neighbour will cut. If the cell still has no end on some
    /// side, the surface ends there: such sides are cut off as far out as the others reach on average (root
    /// of the mean square over their angles), which is half a spacing for a pattern of any kind. If it ends
    /// on all sides but is long and thin, like that of a dense patch's point at the rim of a void, it is cut
    /// off at what a disc of its area can cover.
    float area_at_rim();

 private:
    void cut_off(float radius);
    float full_area() const;  ///< before it is shared with the points exactly above and below

    TangentFrame frame_;
    float reach_, known_, widest_search_, rim_spacing_;
    size_t coincident_ = 0;  ///< neighbours exactly above or below share the cell
    Nearness nearness_;      ///< 1 / reach per direction
    float least_;            ///< the least of these
};

/// Returns two axes in the plane of a normal, and the normal.
TangentFrame tangent_frame(const glm::vec3& normal);
/// Squared ratio of a point's height over the tangent plane to its distance along it, up to which the point
/// continues the surface (14 degrees).
inline constexpr float kSlope2 = 0.25f * 0.25f;

}  // namespace lucarne::octree
