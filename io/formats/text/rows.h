#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/mat3x3.hpp>

#include "io/files/file.h"
#include "io/formats/common/format.h"

// Rows of numbers in text, parsed by all cores: what XYZ, PTS, PTX and the ASCII of PCD have in common.
namespace lucarne::io::text {

/// What becomes of one column.
struct Field {
    enum class Kind : uint8_t {
        position,  ///< axis `to`
        scalar,    ///< a value of `type` at `to`
        packed,  ///< 0x00RRGGBB in the bits of a float or whole number (`type`): three bytes r, g, b at `to`
        skip,    ///< anything
    };
    Kind kind = Kind::skip;
    ScalarType type = ScalarType::f64;
    uint32_t to = 0;
    std::string name;               ///< for messages
    std::optional<uint32_t> alpha;  ///< of `packed`: where the uppermost byte goes
};

/// How the rows of a part of a file become records.
struct RowLayout {
    Schema schema;
    std::vector<Field> fields;  ///< in the order of the columns
    char separator = ' ';       ///< ' ' means blanks; else ',' or ';', with blanks as one likes
    char line_end = '\n';
    bool decimal_comma = false;   ///< "12,5"; a comma is never anything else
    bool has_counts = false;      ///< a row of one whole number says how many rows follow (PTS)
    bool zero_is_missed = false;  ///< (0, 0, 0) is a ray that met nothing (PTX)
    struct Pose {
        glm::dmat3 axes{1.0};  ///< world = axes * p + origin
        glm::dvec3 origin{0.0};
    };
    bool salvage = false;  ///< rows that do not fit are counted and passed over
    std::optional<Pose> pose;
    std::vector<std::byte> blank;  ///< the record before a row is parsed; empty: zeros
};

/// The least bytes of a cell with what ends it: between commas there may be nothing.
inline size_t least_cell_bytes(char separator) {
    return separator == ' ' ? 2 : 1;
}

/// Rows from `begin` to `end` in the file.
struct Section {
    uint64_t begin = 0, end = 0;
    RowLayout layout;
    std::optional<uint64_t> rows;  ///< that have to be there
    uint64_t first_line = 1;       ///< of the section, for messages
};

/// What is kept of a piece of text.
struct Piece {
    std::vector<std::byte> records;  ///< the first `points` of them count
    uint64_t points = 0, dropped = 0, lines = 0;
    uint64_t missed = 0;         ///< rays that met nothing
    uint64_t bad = 0;            ///< rows that do not fit, with `salvage`
    bool ends_in_point = false;  ///< the last line is the last point
    uint64_t promised = 0;       ///< by counts
    std::string problem;         ///< of line `lines`, where something is wrong; nothing behind it is parsed
};

/// Parses whole lines: `text` ends with a line end. A row is dropped where a coordinate is not usable.
void parse_rows(const RowLayout& layout, std::string_view text, Piece& piece);

/// A pass over sections. They share the schema and outlive the reader. Holds a window of 4 MiB of text and
/// its records, however large the file is. Errors, but for layouts with `salvage`: a row that does not fit
/// the layout, fewer rows than promised.
std::unique_ptr<PointReader> read_rows(std::shared_ptr<const ByteSource> file,
                                       const std::vector<Section>& sections);

}  // namespace lucarne::io::text
