#include "octree/cache/checked_read.h"

#include <algorithm>
#include <memory>

#include <xxhash.h>

namespace lucarne::octree {

Result<std::vector<std::byte>> read_checked(const ByteSource& file, uint64_t offset, uint64_t bytes,
                                            uint64_t sum, const std::string& what, size_t behind) {
    std::vector<std::byte> data(bytes + behind);
    const std::span read(data.data(), bytes);
    LUCARNE_TRY(file.read_at(offset, read));
    if (format::checksum(read) != sum) return damaged(file, what + " does not match its checksum");
    return data;
}

Result<uint64_t> checksum_of(const RangeRead& read, uint64_t offset, uint64_t bytes) {
    constexpr size_t kAtOnce = 1 << 16;
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
    XXH3_64bits_reset(state.get());
    std::vector<std::byte> block(kAtOnce);
    for (uint64_t at = 0; at < bytes; at += block.size()) {
        const std::span part(block.data(), std::min<uint64_t>(block.size(), bytes - at));
        LUCARNE_TRY(read(offset + at, part));
        XXH3_64bits_update(state.get(), part.data(), part.size());
    }
    return XXH3_64bits_digest(state.get());
}

}  // namespace lucarne::octree
