#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "io/files/byte_source.h"
#include "octree/cache/format.h"

namespace lucarne::octree {

inline constexpr const char* kConvertAgain = "convert the scan again";

inline auto damaged(const ByteSource& file, std::string why) {
    return rejected(file.path().string(), std::move(why), kConvertAgain);
}

/// Whether [offset, offset + bytes) lies after the superblocks and before `end`.
inline bool inside(uint64_t offset, uint64_t bytes, uint64_t end) {
    return offset >= format::kFirstPayload && offset <= end && bytes <= end - offset;
}

/// Reads a range, checks it against the checksum `sum`, and appends `behind` zeros. The range must have been
/// checked against the file's size.
Result<std::vector<std::byte>> read_checked(const ByteSource& file, uint64_t offset, uint64_t bytes,
                                            uint64_t sum, const std::string& what, size_t behind = 0);

/// Returns the checksum of a long range, which `read` reads in parts.
using RangeRead = std::function<Result<void>(uint64_t offset, std::span<std::byte> out)>;
Result<uint64_t> checksum_of(const RangeRead& read, uint64_t offset, uint64_t bytes);

}  // namespace lucarne::octree
