#pragma once

#include <array>
#include <cstddef>

#include <glm/vec3.hpp>

#include "octree/normals/neighbours/tile.h"

namespace lucarne::octree {

/// A point's share of the surface: its Voronoi cell among its neighbours, in its tangent plane. The cells of
/// all points add up to the surface whatever their pattern, where a share by the number of neighbours in a
/// ball makes a sparse point beside a dense patch as small as the patch's own points, and leaves a hole.
///
/// The cell is held by how far it reaches in kDirections directions. Its area is the mean over these, which
/// may be a hundredth off for one cell and is right in the sum of many. Starts as a disc as wide as the
/// widest cell to be looked for.
class ShareCell {
 public:
    /// `reach`: distance of the farthest of the nearest `neighbours`; `seen`: all that are nearer will be cut
    /// by. More are looked for within widest_search().
    ShareCell(const glm::vec3& normal, float reach, size_t neighbours, float seen);

    /// Cuts off what is nearer to the neighbours in the layer low .. high; all `heights` are over the plane.
    void cut(const Patch& neighbours, const std::vector<float>& heights, const Range& layer);
    /// Cuts, where the cell is open, what is nearer to anything that goes on with the surface: the points of
    /// `around` within `radius` of the site, which is at `centre` there. Returns the nearest of these beyond
    /// the reach, or the tile's count.
    size_t cut_open(const Tile& around, const glm::vec3& centre, float radius);
    /// Whether neighbours beyond the reach may still cut off much: then the known ones say nothing of one
    /// side.
    bool open() const;
    float widest_search() const { return widest_search_; }
    float widest_cut() const;  ///< neighbours at this distance or more cannot cut the cell as it is
    bool closed() const;       ///< neighbours on all sides
    /// The share, where the cell is closed; its area.
    float area() const;
    /// The share of an open cell that no further neighbour will cut. Where it still has no end on some side,
    /// the surface ends: such sides end as far out as the others do on average (root of the mean square over
    /// their angles), which for a pattern of any kind is half a spacing. Where it has one, but is long and
    /// thin as that of a dense patch's point at the rim of a void, it is cut off at what a disc of its own
    /// can cover.
    float area_at_rim();

 private:
    void cut_off(float radius);
    float full_area() const;  ///< before it is shared with what is above and below

    TangentFrame frame_;
    float reach_, known_, widest_search_, rim_spacing_;
    size_t coincident_ = 0;  ///< neighbours exactly above or below share the cell
    Nearness nearness_;      ///< one over how far it reaches
    float least_;            ///< of these
};

/// Axes in the plane of a normal.
TangentFrame tangent_frame(const glm::vec3& normal);
/// What goes on with the surface: its height over the tangent plane, over its distance along it, squared (14
/// degrees).
inline constexpr float kSlope2 = 0.25f * 0.25f;

}  // namespace lucarne::octree
