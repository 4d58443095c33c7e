#pragma once

#include <array>
#include <cstddef>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace lucarne::octree {

/// A point's share of the surface: its Voronoi cell among its neighbours, in its tangent plane. The cells of
/// all points add up to the surface whatever their pattern, where a share by the number of neighbours in a
/// ball makes a sparse point beside a dense patch as small as the patch's own points, and leaves a hole.
///
/// Starts as an octagon as wide as the widest cell to be looked for; neighbours cut it, nearest first.
class ShareCell {
 public:
    /// `reach`: distance of the farthest of the `neighbours` known so far; more are looked for within
    /// widest_search().
    ShareCell(const glm::vec3& normal, float reach, size_t neighbours);

    void cut(const glm::vec3& offset);  ///< by the bisector of the point (the origin) and a neighbour
    /// Whether neighbours beyond the reach may still cut off much: then the known ones say nothing of one
    /// side.
    bool open() const;
    /// Neighbours at this distance or more cannot cut the cell as it is.
    float widest_cut() const { return 2 * farthest_; }
    float widest_search() const { return widest_search_; }
    /// Whether the surface goes on at `offset`, and a point there would cut a side that is open still.
    bool wants(const glm::vec3& offset) const;
    /// The share, where the cell is closed; its area.
    float area() const;
    bool closed() const;  ///< neighbours on all sides
    /// The share of an open cell that no further neighbour will cut. Where it still has no end on some side,
    /// the surface ends: such sides end as far out as the others do on average (root of the mean square over
    /// their angles), which for a pattern of any kind is half a spacing. Where it has one, but is long and
    /// thin as that of a dense patch's point at the rim of a void, it is cut off at what a disc of its own
    /// can cover.
    float area_at_rim();

 private:
    struct Corner {
        glm::vec2 at;
        bool bound;  ///< the side from here to the next corner is no neighbour's, but the octagon's
    };
    static constexpr size_t kMostCorners = 32;

    void cut(const glm::vec2& direction, float distance, bool bound);
    void cut_off(float radius);  ///< by an octagon
    void measure();
    float mean_square_of_sides() const;

    glm::vec3 normal_, x_{0.0f}, y_{0.0f};
    float reach_, widest_search_, rim_spacing_,
        farthest_ = 0;                   ///< farthest_: the distance of the farthest corner
    size_t count_ = 0, coincident_ = 0;  ///< neighbours exactly above or below share the cell
    std::array<Corner, kMostCorners> corners_;  ///< the first count_ of them, counter-clockwise
};

}  // namespace lucarne::octree
