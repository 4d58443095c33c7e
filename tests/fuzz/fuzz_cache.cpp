// Fuzzes the cache reader and the code that trusts it. The checksums would stop any mutated cache, so they
// are corrected first: the aim is to test deliberate lies, not accidents. The input is a cache without the
// zeros after the fields of its superblocks: the first 88 bytes of the file and everything from byte 8192 on.
#include <algorithm>
#include <cstring>
#include <string>

#include "gi/scene/scene.h"
#include "gi/surfels/surfel_pool.h"
#include "octree/cache/cache.h"
#include "octree/cache/format.h"
#include "octree/stream/cut.h"
#include "tests/fuzz/fuzz.h"

namespace lucarne::octree {
namespace {

constexpr size_t kFields = 88;

/// Returns a part of the file; empty if it reaches beyond the file.
std::span<std::byte> part(std::span<std::byte> file, uint64_t offset, uint64_t bytes) {
    if (offset > file.size() || bytes > file.size() - offset) return {};
    return file.subspan(offset, bytes);
}

/// Corrects magic, version, size and every checksum.
void reseal(std::span<std::byte> file) {
    uint64_t fields[8];
    std::memcpy(fields, &file[16], sizeof fields);
    format::Superblock block{fields[0], fields[1], fields[2], 0, fields[4], fields[5], 0, file.size()};
    const auto directory = part(file, block.directory_offset, block.directory_bytes);
    for (size_t at = 0; at + format::kEntryBytes <= directory.size(); at += format::kEntryBytes) {
        format::Entry entry = format::load_entry(&directory[at]);
        entry.checksum = format::checksum(part(file, entry.payload_offset, entry.payload_bytes));
        format::store_entry(entry, &directory[at]);
    }
    block.directory_checksum = format::checksum(directory);
    block.metadata_checksum = format::checksum(part(file, block.metadata_offset, block.metadata_bytes));
    const auto encoded = format::encode(block);
    std::copy(encoded.begin(), encoded.end(), file.begin());
    std::copy(encoded.begin(), encoded.end(), file.begin() + format::kSuperblockBytes);
}

/// Reads every node as rendering would, and selects cuts by what the directory claims.
void use(const NodeSource& source) {
    const auto& header = source.header();
    const gi::Scene scene = gi::default_scene(header.min, header.max, header.metres_per_unit);
    for (uint32_t node = 0; node < source.nodes().size(); ++node) {
        const auto data = source.load(node);
        if (data) (void)gi::pack_surfels(header, source.nodes()[node], *data, scene);
    }
    View view;
    view.position = scene.cameras[0].position;
    view.width = view.height = 64;
    (void)view_cut(source, view, 1000);
    (void)light_view_cut(source, view, 1000);
    (void)light_cut(source, header.min, 1000);
}

}  // namespace
}  // namespace lucarne::octree

bool lucarne::fuzz::run(const uint8_t* data, size_t size) {
    if (size < octree::kFields) return false;
    std::string bytes(octree::format::kFirstPayload + size - octree::kFields, '\0');
    std::memcpy(bytes.data(), data, octree::kFields);
    std::memcpy(&bytes[octree::format::kFirstPayload], data + octree::kFields, size - octree::kFields);
    octree::reseal(std::as_writable_bytes(std::span(bytes)));
    const auto file = memory_source(bytes);
    (void)octree::verify_cache(file, [](uint64_t) {});
    const auto opened = octree::open_cache(file);
    if (opened) octree::use(**opened);
    return true;
}
