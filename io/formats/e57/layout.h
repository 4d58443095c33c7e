#pragma once

#include "io/formats/e57/packets.h"
#include "io/points.h"

// Combines scans with different fields into one stream of records with one schema.
namespace lucarne::io::e57 {

/// An attribute of one component: the value of a field, or the value times `gain`.
struct Target {
    std::optional<size_t> field;  ///< none if this scan has no such field; `missing` is used then
    ScalarType type = ScalarType::f64;
    uint32_t offset = 0;  ///< in the record
    double gain = 1.0;
    double missing = 0.0;
};

/// How the records of one scan become records of the schema.
struct ScanLayout {
    std::array<size_t, 3> coordinates{};  ///< x, y, z or range, azimuth, elevation
    bool spherical = false;
    std::optional<size_t> invalid;        ///< field that marks invalid points
    std::optional<size_t> color_invalid;  ///< field that marks invalid colours
    std::optional<Pose> pose;             ///< none if it moves nothing
    std::vector<Target> targets;
    std::array<Target, 3> color;                  ///< the three colour components, if the schema has colour
    std::optional<std::array<size_t, 3>> normal;  ///< the three fields of the normal; the pose turns it
    uint16_t station = 0;
    bool zero_is_missed = false;  ///< a point at the scanner itself is a ray that hit nothing
};

struct Layout {
    Schema schema;
    uint32_t color_bits = 8;
    std::vector<ScanLayout> scans;
};

inline constexpr std::array<std::string_view, 3> kColorFields = {"colorRed", "colorGreen", "colorBlue"};
/// Returns the largest colour component of the first `most` records of a scan; 0 if there is none.
double largest_color(const Scan& scan, RecordReader& reader, uint64_t most);

/// Returns a layout with the union of the scans' fields. Scans without records are ignored. Errors: scans
/// without coordinates, more than kMostFields attributes in all.
Result<Layout> make_layout(const std::string& file, const Document& document);

/// Returns how many of the `count` records that `reader` holds lie exactly at the origin of their scan.
size_t count_at_origin(const Scan& scan, const ScanLayout& layout, const RecordReader& reader, size_t count);

/// Converts the block that `reader` holds to consecutive records at `to`. Leaves out points that are invalid,
/// missed rays, or not finite.
struct Converted {
    size_t kept = 0, invalid = 0, missed = 0;
};
Converted convert_block(const Schema& schema, const Scan& scan, const ScanLayout& layout,
                        const RecordReader& reader, size_t count, std::byte* to);

}  // namespace lucarne::io::e57
