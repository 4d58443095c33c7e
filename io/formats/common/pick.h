#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "io/files/file.h"

namespace lucarne::io {

/// Reads some records of `length` bytes each from a file and calls `take` with the bytes of each. The records
/// begin at `begin`; `indices` must ascend. Records near each other are read at once, up to 256 KiB; records
/// further apart are read one by one. The cost therefore depends on the picked points, not on the size of the
/// file.
template <class Take>
Result<void> for_picked(const ByteSource& file, uint64_t begin, size_t length,
                        std::span<const uint64_t> indices, const Take& take) {
    constexpr uint64_t kNear = 8192, kMost = uint64_t{256} << 10;  // bytes
    std::vector<std::byte> bytes;
    for (size_t first = 0; first < indices.size();) {
        const uint64_t from = indices[first] * length;
        size_t last = first + 1;
        while (last < indices.size() && (indices[last] - indices[last - 1]) * length <= kNear &&
               (indices[last] + 1) * length - from <= kMost)
            ++last;
        bytes.resize(static_cast<size_t>((indices[last - 1] + 1) * length - from));
        LUCARNE_TRY(file.read_at(begin + from, bytes));
        for (; first < last; ++first) take(&bytes[static_cast<size_t>(indices[first] * length - from)]);
    }
    return {};
}

}  // namespace lucarne::io
