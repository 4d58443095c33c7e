#include "io/files/byte_source.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

namespace lucarne {

Result<void> ByteSource::read_at(uint64_t offset, std::span<std::byte> out) const {
    LUCARNE_ASSIGN(const size_t got, read_some(offset, out));
    if (got == out.size()) return {};
    return rejected(path_.string(),
                    fmt::format("ends early: {} bytes wanted at {}, {} there", out.size(), offset, got));
}

Result<size_t> MemorySource::read_some(uint64_t offset, std::span<std::byte> out) const {
    if (offset >= bytes_.size()) return size_t{0};
    const auto there = bytes_.subspan(static_cast<size_t>(offset));
    const size_t count = std::min(there.size(), out.size());
    if (count > 0) std::memcpy(out.data(), there.data(), count);
    return count;
}

}  // namespace lucarne
