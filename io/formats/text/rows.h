#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/mat3x3.hpp>

#include "io/files/file.h"
#include "io/formats/common/format.h"

// Rows of numbers in text, parsed by all cores. XYZ, PTS, PTX and ASCII PCD share this.
namespace lucarne::io::text {

/// What one column becomes.
struct Field {
    enum class Kind : uint8_t {
        position,  ///< axis number `to`
        scalar,    ///< a value of `type` at `to`
        packed,  ///< 0x00RRGGBB in the bits of a float or whole number (`type`): three bytes r, g, b at `to`
        skip,    ///< ignored
    };
    Kind kind = Kind::skip;
    ScalarType type = ScalarType::f64;
    uint32_t to = 0;
    std::string name;               ///< for error messages
    std::optional<uint32_t> alpha;  ///< for `packed`: where the highest byte goes
};

/// How the rows of a part of a file become records.
struct RowLayout {
    Schema schema;
    std::vector<Field> fields;  ///< in the order of the columns
    char separator = ' ';  ///< ' ' means blanks; otherwise ',' ';' or a tab, with optional blanks around it
    char line_end = '\n';
    bool decimal_comma = false;   ///< "12,5"; every comma is a decimal comma
    bool has_counts = false;      ///< a row of one whole number states how many rows follow (PTS)
    bool zero_is_missed = false;  ///< (0, 0, 0) is a ray that hit nothing (PTX)
    struct Pose {
        glm::dmat3 axes{1.0};  ///< world = axes * p + origin
        glm::dvec3 origin{0.0};
    };
    bool salvage = false;  ///< count and skip rows that do not fit
    std::optional<Pose> pose;
    std::vector<std::byte> blank;  ///< initial content of a record; empty means zeros
};

/// Returns the fewest bytes of a cell with its separator: between commas there may be nothing.
inline size_t least_cell_bytes(char separator) {
    return separator == ' ' ? 2 : 1;
}

/// Rows from `begin` to `end` in the file.
struct Section {
    uint64_t begin = 0, end = 0;
    RowLayout layout;
    std::optional<uint64_t> rows;  ///< if set, exactly as many rows must be there
    uint64_t first_line = 1;       ///< number of its first line, for error messages
};

/// The result of parsing a piece of text.
struct Piece {
    std::vector<std::byte> records;  ///< only the first `points` of them are valid
    uint64_t points = 0, dropped = 0, lines = 0;
    uint64_t missed = 0;         ///< rays that hit nothing
    uint64_t bad = 0;            ///< rows that do not fit, with `salvage`
    bool ends_in_point = false;  ///< the last line is the last point
    uint64_t promised = 0;       ///< by counts
    std::string problem;         ///< error in line number `lines`; nothing after it is parsed
};

/// Parses whole lines: `text` must end with a line end. Drops a row with an unusable coordinate.
void parse_rows(const RowLayout& layout, std::string_view text, Piece& piece);

/// Starts a pass over sections, which must share the schema and outlive the reader. Holds a window of 4 MiB
/// of text and its records, however large the file is. Errors, except for layouts with `salvage`: a row that
/// does not fit the layout, fewer rows than promised.
std::unique_ptr<PointReader> read_rows(std::shared_ptr<const ByteSource> file,
                                       const std::vector<Section>& sections);

}  // namespace lucarne::io::text
