#pragma once

#include <array>
#include <cstddef>

#include <glm/vec3.hpp>

#include "octree/normals/tile.h"

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
    /// `reach`: distance of the farthest of the `neighbours` known so far; more are looked for within
    /// widest_search().
    ShareCell(const glm::vec3& normal, float reach, size_t neighbours);

    /// Cuts off what is nearer to the neighbours in the layer low .. high; all `heights` are over the plane.
    void cut(const Patch& neighbours, const std::vector<float>& heights, const Range& layer);
    /// Cuts, where the cell is open, what is nearer to anything that goes on with the surface.
    void cut_open(const Patch& around);
    /// Whether a point is low enough over the tangent plane to go on with the surface.
    bool goes_on(const Patch& around, size_t i) const;
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

    const glm::vec3& x_axis() const { return x_; }
    const glm::vec3& y_axis() const { return y_; }

 private:
    float least() const;
    void cut_off(float radius);
    float mean_square_within(float radius) const;

    glm::vec3 normal_, x_{0.0f}, y_{0.0f};
    float reach_, widest_search_, rim_spacing_;
    size_t coincident_ = 0;                    ///< neighbours exactly above or below share the cell
    std::array<float, kDirections> nearness_;  ///< one over how far it reaches
};

}  // namespace lucarne::octree
