#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "io/core/error.h"
#include "io/formats/scan.h"
#include "io/points.h"
#include "octree/cluster/ranks.h"

namespace lucarne::viewer {

/// What the header of a scan says.
struct ScanHeader {
    io::Schema schema;
    io::ScanInfo info;
};

/// Opens scans for their headers. Each has a header or an error.
std::vector<Result<ScanHeader>> read_headers(const std::vector<std::string>& paths,
                                             const io::ReadOptions& options);

/// Does the same on several ranks: each opens about equally many files, prints the warnings about these, and
/// tells the others. A header that does not survive being told, for example because a number in it is not
/// finite, is read by every rank. A meeting. Errors: the ranks run different programs or have different
/// paths.
Result<std::vector<Result<ScanHeader>>> read_headers_together(const std::vector<std::string>& paths,
                                                              const io::ReadOptions& options,
                                                              octree::Ranks& ranks);

/// A header as bytes, for ranks of the same program. Empty if the bytes would not give the same header.
octree::Ranks::Bytes encode_header(const ScanHeader& header);
/// Errors: the bytes are damaged.
Result<ScanHeader> decode_header(std::span<const std::byte> bytes);

}  // namespace lucarne::viewer
