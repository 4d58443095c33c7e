#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <glm/vec3.hpp>

namespace lucarne::octree {

/// The line in a point's tangent plane where its surface ends: at a crease, where another plane begins, or at
/// a border, beyond which there is nothing. The point's disc has no part beyond it.
struct EdgeLine {
    glm::vec3 toward{0.0f};  ///< unit, in the tangent plane: from the point to the line, at right angles
    float distance = 0;      ///< of the line, in roots of the point's own share of the surface (its area)
};

/// A line in two bytes. The first is its direction: with k the axis along which the normal is longest (the
/// first of several), the components of `toward` along the two axes after k (cyclically) as a turn of
/// edge_turn.h in steps of 1/64. This does not depend on the normal's sign, and hardly on its rounding. The
/// second is distance * 64; 0: no line, and the first byte is 0, too.
using EdgeCode = std::array<uint8_t, 2>;
inline constexpr EdgeCode kNoEdge = {0, 0};
/// Lines farther away are not kept: the discs of raw scans reach 1.5.
inline constexpr float kFarthestEdge = 255.0f / 64;

/// Returns the axis along which a vector is longest, the first of several: 0 to 2.
int longest_axis(const glm::vec3& v);

/// `normal`: unit. The line's direction is projected on the plane. kNoEdge for lines beyond kFarthestEdge,
/// for directions that are nearly at right angles to the plane, and for what is not finite. Lines nearer than
/// 1/64 are moved there.
EdgeCode encode_edge(const glm::vec3& normal, const EdgeLine& line);
/// Returns nothing for kNoEdge, and for a normal that is zero.
std::optional<EdgeLine> decode_edge(const glm::vec3& normal, EdgeCode code);

/// A point's normal and share of the surface, on which the code of its line depends.
struct EdgeBase {
    glm::vec3 normal{0.0f};
    double area = 0;  ///< in any unit; 0: unknown
};
/// Returns the code of the same line for another base: after rounding, or for the input's own normal. kNoEdge
/// where the normals differ by more than 20 degrees, whatever their signs.
EdgeCode rebased_edge(EdgeCode code, const EdgeBase& from, const EdgeBase& to);

}  // namespace lucarne::octree
