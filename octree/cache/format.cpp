#include "octree/cache/format.h"

#include <cstring>

#include <xxhash.h>

namespace lucarne::octree::format {
namespace {

constexpr size_t kChecked = 80;  // bytes of the superblock under its own checksum, which follows them

using io::load;
using io::store;

}  // namespace

uint64_t checksum(std::span<const std::byte> data) {
    return XXH3_64bits(data.data(), data.size());
}

SuperblockBytes encode(const Superblock& block) {
    SuperblockBytes bytes{};
    std::memcpy(bytes.data(), kMagic.data(), kMagic.size());
    store<uint32_t>(&bytes[8], block.version);
    store<uint32_t>(&bytes[12], kEntryBytes);
    const uint64_t fields[8] = {block.generation,         block.directory_offset, block.directory_bytes,
                                block.directory_checksum, block.metadata_offset,  block.metadata_bytes,
                                block.metadata_checksum,  block.file_bytes};
    std::memcpy(&bytes[16], fields, sizeof fields);
    store<uint64_t>(&bytes[kChecked], checksum(std::span(bytes).first(kChecked)));
    return bytes;
}

std::optional<Superblock> decode(std::span<const std::byte, kSuperblockBytes> bytes) {
    if (std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0) return std::nullopt;
    const auto version = load<uint32_t>(&bytes[8]);
    if ((version != kVersion && version != kWideVersion) || load<uint32_t>(&bytes[12]) != kEntryBytes)
        return std::nullopt;
    if (load<uint64_t>(&bytes[kChecked]) != checksum(bytes.first(kChecked))) return std::nullopt;
    const auto field = [&](size_t i) { return load<uint64_t>(&bytes[16 + 8 * i]); };
    return Superblock{field(0), field(1), field(2), field(3), field(4),
                      field(5), field(6), field(7), version};
}

void store_entry(const Entry& entry, std::byte* at) {
    store(at, entry.payload_offset);
    store(at + 8, entry.subtree_count);
    store(at + 16, entry.checksum);
    store(at + 24, entry.key.x);
    store(at + 28, entry.key.y);
    store(at + 32, entry.key.z);
    store(at + 36, entry.count);
    store(at + 40, entry.payload_bytes);
    store(at + 44, static_cast<uint8_t>(entry.key.level));
    store(at + 45, entry.child_mask);
    store(at + 46, entry.codec);
    store(at + 47, entry.layout);
    store(at + 48, entry.area_floor);
}

Entry load_entry(const std::byte* at) {
    Entry entry;
    entry.payload_offset = load<uint64_t>(at);
    entry.subtree_count = load<uint64_t>(at + 8);
    entry.checksum = load<uint64_t>(at + 16);
    entry.key = {load<uint8_t>(at + 44), load<uint32_t>(at + 24), load<uint32_t>(at + 28),
                 load<uint32_t>(at + 32)};
    entry.count = load<uint32_t>(at + 36);
    entry.payload_bytes = load<uint32_t>(at + 40);
    entry.child_mask = load<uint8_t>(at + 45);
    entry.codec = load<uint8_t>(at + 46);
    entry.layout = load<uint8_t>(at + 47);
    entry.area_floor = load<std::array<float, kPrefixSteps>>(at + 48);
    return entry;
}

void store_page(const Page& page, std::byte* at) {
    store(at, page.checksum);
    store(at + 8, page.first_child);
    store(at + 12, uint32_t{0});
}

Page load_page(const std::byte* at) {
    return {load<uint64_t>(at), load<uint32_t>(at + 8)};
}

}  // namespace lucarne::octree::format
