// The two sides of surfels, which are opaque sheets: light of one side never reaches the other.
#pragma once

#include <cstdint>
#include <span>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "gi/shared/surfel.h"

namespace lucarne::gi::paths {

/// Twice the number of a surfel, and one more for its back.
using Side = uint32_t;
/// No side, group or point.
inline constexpr uint32_t kNone = 0xffffffffu;

/// Returns the unit normal on this side.
inline glm::vec3 normal_of(std::span<const Surfel> surfels, Side side) {
    const glm::vec3& normal = surfels[side / 2].normal;
    return side % 2 ? -normal : normal;
}

inline constexpr uint32_t kFacings = 6;
/// Returns to which side of a cube a normal is nearest: +x, -x, +y, -y, +z, -z. The two sides of a surfel
/// differ in the lowest bit.
inline uint32_t facing_of(const glm::vec3& normal) {
    const glm::vec3 size = glm::abs(normal);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    return static_cast<uint32_t>(2 * axis + (normal[axis] < 0));
}

}  // namespace lucarne::gi::paths
