#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/tree/source.h"

namespace lucarne::viewer {

/// The field of a normal that was estimated when the scan was converted.
inline constexpr std::string_view kEstimatedNormal = "normal (estimated)";

/// An attribute of a point as people read it: "classification", "2 ground".
struct PointField {
    std::string name, value;
    bool operator==(const PointField&) const = default;
};

/// A point of a scan with all that the scan says of it.
struct ExactPoint {
    glm::dvec3 position{0.0};                ///< world: in the unit of the whole source
    std::array<std::string, 3> coordinates;  ///< in its own file's system and unit, to the last digit
    std::vector<PointField> fields;          ///< every attribute, and the scan's name
};

/// The coordinates of a record in decimal: integer * scale + offset without any rounding, with as many
/// decimals as the scale and the offset have; floats in the fewest digits that read back as the same float.
std::array<std::string, 3> coordinate_texts(const io::Schema& schema, const std::byte* record);

/// `record` is one of those that source.load(node) gives.
ExactPoint exact_point(const octree::NodeSource& source, uint32_t node, const std::byte* record);

}  // namespace lucarne::viewer
