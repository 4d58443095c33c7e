#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "octree/tree/source.h"

/// The bytes of a cache file as octree/FORMAT.md defines them, for the reader and the writer.
namespace lucarne::octree::format {

static_assert(std::endian::native == std::endian::little,
              "caches are written and read as they lie in memory");

inline constexpr std::array<uint8_t, 8> kMagic = {'L', 'U', 'C', 'A', 'R', 'N', 'E', 0x1a};
inline constexpr uint32_t kVersion = 2;
/// The version of caches whose scan numbers have 32 bits. Readers of version 2 would mix up the scans.
inline constexpr uint32_t kWideVersion = 3;
inline constexpr size_t kSuperblockBytes = 4096;
inline constexpr uint64_t kFirstPayload = 2 * kSuperblockBytes;
inline constexpr size_t kEntryBytes = 64;
inline constexpr uint8_t kCodecRaw = 0;      ///< the payload is the node's records, unchanged
inline constexpr uint8_t kCodecColumns = 1;  ///< compressed: octree/codec
inline constexpr uint64_t kMaxMetadata = uint64_t{64} << 20;
inline constexpr uint32_t kMaxStride = 1 << 16;

/// XXH3, 64 bits, seed 0.
uint64_t checksum(std::span<const std::byte> data);

struct Superblock {
    uint64_t generation = 0;
    uint64_t directory_offset = 0, directory_bytes = 0, directory_checksum = 0;
    uint64_t metadata_offset = 0, metadata_bytes = 0, metadata_checksum = 0;
    uint64_t file_bytes = 0;  ///< everything that this state needs lies before this offset
    uint32_t version = kVersion;
    bool operator==(const Superblock&) const = default;
};
using SuperblockBytes = std::array<std::byte, kSuperblockBytes>;
SuperblockBytes encode(const Superblock& block);
/// Empty unless magic, version (one of the two), entry size and checksum are right.
std::optional<Superblock> decode(std::span<const std::byte, kSuperblockBytes> bytes);

/// One node's entry in the directory.
struct Entry {
    NodeKey key;
    uint8_t child_mask = 0;
    uint8_t codec = kCodecRaw;
    uint8_t layout = 0;  ///< 0: stored in the cache's schema; i: in the schema layouts[i - 1]
    uint32_t count = 0;
    uint32_t payload_bytes = 0;
    uint64_t payload_offset = 0;
    uint64_t subtree_count = 0;
    uint64_t checksum = 0;
    std::array<float, kPrefixSteps> area_floor{};
};
void store_entry(const Entry& entry, std::byte* at);
Entry load_entry(const std::byte* at);

/// What a page of the directory needs to be read by itself.
struct Page {
    uint64_t checksum = 0;     ///< of the page's entries
    uint32_t first_child = 1;  ///< number of the first node whose parent is in this page or a later one
    bool operator==(const Page&) const = default;
};
inline constexpr size_t kPageBytes = 16;
inline constexpr uint32_t kLeastPageNodes = 8, kMostPageNodes = 1 << 16;
void store_page(const Page& page, std::byte* at);
Page load_page(const std::byte* at);

}  // namespace lucarne::octree::format
