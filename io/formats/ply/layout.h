#pragma once

#include <vector>

#include "io/formats/ply/header.h"

// Converts a PLY vertex to a record of the schema.
namespace lucarne::io::ply {

/// The scalar properties of a vertex, packed in order. A binary record without lists has this form already;
/// otherwise the record is packed first.
struct Layout {
    /// Copies, byte-swaps or converts `count` neighbouring scalars.
    struct Step {
        enum class Kind : uint8_t {
            copy,
            swap,
            to_double,
            to_u16,  ///< clamps
        } kind = Kind::copy;
        ScalarType type = ScalarType::u8;  ///< in the file
        uint32_t from = 0, to = 0, count = 1;
    };
    /// A scalar property, and the component of an attribute that it becomes. The attribute "" is the
    /// position.
    struct Column {
        Property property;
        std::string attribute;
        uint32_t component = 0;
    };
    Schema schema;
    std::vector<Column> columns;  ///< in the order of the file
    std::vector<Step> steps;
    uint32_t packed_bytes = 0;
    bool big_endian = false;
    bool flat = false;  ///< the file has no z, so z is 0

    /// Returns false if a coordinate is not finite; the record is then invalid.
    bool unpack(const std::byte* packed, std::byte* record) const;
};

/// Maps `x`, `y`, `z` to the position: f32 if all three are float, otherwise f64, which holds every PLY type.
/// Maps red/green/blue (or diffuse_red..., r/g/b) to `color`: whole numbers of more than a byte become u16,
/// real ones of one type keep it. Maps nx/ny/nz (or normal_x...) to `normal`, if their types allow it.
/// Everything else keeps its name and type. Properties without a name are left out.
Layout make_layout(const std::vector<Property>& properties, Encoding encoding);

}  // namespace lucarne::io::ply
