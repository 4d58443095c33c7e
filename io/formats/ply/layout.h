#pragma once

#include <vector>

#include "io/formats/ply/header.h"

// How a PLY vertex becomes a record of ours.
namespace lucarne::io::ply {

/// The scalar properties of a vertex, packed in order: the file's own record where it is binary and has no
/// lists, else put together first.
struct Layout {
    /// Copies, byte-swaps or widens `count` neighbouring scalars.
    struct Step {
        enum class Kind : uint8_t { copy, swap, to_double } kind = Kind::copy;
        ScalarType type = ScalarType::u8;  ///< in the file
        uint32_t from = 0, to = 0, count = 1;
    };
    /// A scalar property and the component it became. The attribute "" is the position.
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
    bool flat = false;  ///< the file has no z: it is 0

    /// False (and the record is of no use) where a coordinate is not finite.
    bool unpack(const std::byte* packed, std::byte* record) const;
};

/// `x`, `y`, `z` become the position: f32 where all three are float, else f64, which holds every PLY type.
/// red/green/blue (or diffuse_red..., r/g/b) become `color`, nx/ny/nz (or normal_x...) `normal`, where their
/// types allow; everything else keeps its name and type.
/// What has no name is left out.
Layout make_layout(const std::vector<Property>& properties, Encoding encoding);

}  // namespace lucarne::io::ply
