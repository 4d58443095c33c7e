#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/tree/source.h"

namespace lucarne::viewer {

/// Name of the field for a normal that was estimated during conversion.
inline constexpr std::string_view kEstimatedNormal = "normal (estimated)";

/// An attribute of a point as readable text: "classification", "2 ground".
struct PointField {
    std::string name, value;
    bool operator==(const PointField&) const = default;
};

/// A point of a scan with all its attributes.
struct ExactPoint {
    glm::dvec3 position{0.0};                ///< world coordinates, in the unit of the whole source
    std::array<std::string, 3> coordinates;  ///< in the file's coordinate system and unit, to the last digit
    std::vector<PointField> fields;          ///< every attribute and the scan's name
};

/// Returns the coordinates of a record as decimal texts: integer * scale + offset without rounding, with as
/// many decimals as scale and offset have. Floats are written with the fewest digits that read back as the
/// same float.
std::array<std::string, 3> coordinate_texts(const io::Schema& schema, const std::byte* record);

/// Returns the point of a record; `record` must be one of the records of source.load(node).
ExactPoint exact_point(const octree::NodeSource& source, uint32_t node, const std::byte* record);

}  // namespace lucarne::viewer
