#pragma once

#include "io/formats/e57/packets.h"
#include "io/points.h"

// Scans with fields of their own become one stream of records with one schema.
namespace lucarne::io::e57 {

/// An attribute of one component: the field's value, as it is or times `gain`.
struct Target {
    std::optional<size_t> field;  ///< none where this scan has no such field: `missing`
    ScalarType type = ScalarType::f64;
    uint32_t offset = 0;  ///< in the record
    double gain = 1.0;
    double missing = 0.0;
};

/// How the records of one scan become ours.
struct ScanLayout {
    std::array<size_t, 3> coordinates{};  ///< x, y, z or range, azimuth, elevation
    bool spherical = false;
    std::optional<size_t> invalid;        ///< the field that says which points are invalid
    std::optional<size_t> color_invalid;  ///< the field that says which colours are
    std::optional<Pose> pose;             ///< only one that moves
    std::vector<Target> targets;
    std::array<Target, 3> color;                  ///< the three of colour, unless the schema has none
    std::optional<std::array<size_t, 3>> normal;  ///< turned by the pose
    uint16_t station = 0;
};

struct Layout {
    Schema schema;
    uint32_t color_bits = 8;
    std::vector<ScanLayout> scans;
};

/// The union of the scans' fields; scans without records count for nothing. Errors: scans without
/// coordinates, more than kMostFields attributes in all.
Result<Layout> make_layout(const std::string& file, const Document& document);

/// Writes the block that `reader` holds behind one another at `to`, without the points that are invalid or
/// not finite.
struct Converted {
    size_t kept = 0, invalid = 0;
};
Converted convert_block(const Schema& schema, const Scan& scan, const ScanLayout& layout,
                        const RecordReader& reader, size_t count, std::byte* to);

}  // namespace lucarne::io::e57
