#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "io/files/file.h"
#include "io/formats/common/remarks.h"

// The header of a PCD file. Source: Point Cloud Library, "The PCD (Point Cloud Data) file format", versions
// 0.6 and 0.7.
namespace lucarne::io::pcd {

enum class Encoding { ascii, binary, compressed };

struct Field {
    std::string name;
    ScalarType type = ScalarType::f32;
    uint32_t count = 1;
    size_t bytes() const { return scalar_bytes(type) * count; }
};

struct Header {
    Encoding encoding = Encoding::ascii;
    std::vector<Field> fields;
    uint64_t points = 0, width = 0, height = 1;
    std::array<double, 7> viewpoint = {0, 0, 0, 1, 0, 0, 0};  ///< x, y, z, then a quaternion w, x, y, z
    std::vector<std::string> comments;                        ///< the lines without "# "
    uint64_t data_offset = 0;
    uint64_t data_line = 1;  ///< line number of the first line of data
    uint64_t record_bytes() const;
};

/// Reads the header. Rejects a header that is malformed, larger than 1 MiB or without x, y and z, or that
/// contradicts itself.
Result<Header> read_header(const std::shared_ptr<const ByteSource>& file);

}  // namespace lucarne::io::pcd
