#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/files/file.h"
#include "io/formats/common/remarks.h"

// The header of a PLY file. Source: Greg Turk, "The PLY Polygon File Format", 1994, and the sized type names
// that later writers use.
namespace lucarne::io::ply {

enum class Encoding { ascii, little_endian, big_endian };

struct Property {
    std::string name;
    ScalarType type = ScalarType::f32;  ///< for a list, the type of its entries
    std::optional<ScalarType> count;    ///< only for a list: the type of its length
};

struct Element {
    std::string name;
    uint64_t count = 0;
    std::vector<Property> properties;
    bool has_list() const;
    uint64_t record_bytes() const;  ///< in the binary encodings; only without lists
};

struct Header {
    Encoding encoding = Encoding::ascii;
    std::vector<Element> elements;
    std::vector<std::string> comments, infos;  ///< the lines without "comment " and "obj_info "
    uint64_t data_offset = 0;
    char line_end = '\n';  ///< '\r' in files of old Macintoshes

    size_t vertex = 0;  ///< index of the vertex element
    const Element& vertices() const { return elements[vertex]; }
};

/// Reads the header. Rejects a header that is malformed, larger than 1 MiB, or without a vertex element with
/// x and y (or the positions of compressed splats). Without `salvage` also rejects one that promises more
/// entries than the file has bytes.
Result<Header> read_header(const std::shared_ptr<const ByteSource>& file, bool salvage = false);

/// Returns the type that "uchar", "uint8"... name; empty for unknown words.
std::optional<ScalarType> type_of(std::string_view word);
std::string_view word_of(ScalarType type);  ///< "uchar"; empty for 64-bit integers, which PLY lacks

/// Returns the properties and comments, for a later export.
PlyNotes notes_of(const Header& header);

}  // namespace lucarne::io::ply
