// Makes caches with few points and several levels in the form that fuzz_cache takes, without and with
// synthetic surfels. The converter would make only one node of so few points.
#include "octree/cache/cache.h"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "octree/cache/writer.h"
#include "octree/codec/payload.h"
#include "octree/tree/filling.h"
#include "tests/fuzz/seeds/seeds.h"

namespace lucarne::octree {
namespace {

SourceHeader header() {
    SourceHeader header;
    header.schema.position = io::PositionType::f32;
    header.schema.stride = 12;
    header.schema.add(std::string(io::names::color), io::ScalarType::u8, 3);
    header.schema.add(std::string(io::names::normal_oct), io::ScalarType::u8, 3);
    header.schema.add(std::string(io::names::area), io::ScalarType::u16);
    header.schema.add(std::string(io::names::classification), io::ScalarType::u8);
    header.min = glm::dvec3(1);  // add_node() enlarges them
    header.max = glm::dvec3(0);
    io::ScanInfo scan;
    scan.path = "a.las";
    scan.stations.push_back({1, {0.5, 0.5, 0.5}});
    header.scans = {scan};
    return header;
}

/// Adds a node with `count` points spread over its cube.
Result<void> add_node(CacheWriter& writer, SourceHeader& whole, NodeKey key, uint8_t children, uint32_t count,
                      uint64_t below) {
    const uint32_t stride = whole.schema.stride;
    std::vector<std::byte> records(size_t{count} * stride, std::byte{64});
    const Cube cube = whole.root.of(key);
    for (uint32_t i = 0; i < count; ++i) {
        const glm::vec3 point(cube.min + cube.size * (i + 0.5) / static_cast<double>(count));
        for (int axis = 0; axis < 3; ++axis)
            io::store(&records[i * stride + 4 * static_cast<size_t>(axis)], point[axis]);
        whole.min = glm::min(whole.min, glm::dvec3(point));
        whole.max = glm::max(whole.max, glm::dvec3(point));
    }
    format::Entry entry;
    entry.key = key;
    entry.child_mask = children;
    entry.count = count;
    entry.subtree_count = count + below;
    entry.payload_bytes = static_cast<uint32_t>(records.size());
    LUCARNE_ASSIGN(entry.payload_offset, writer.append(records));
    entry.checksum = format::checksum(records);
    entry.area_floor = {0.1f, 0.2f, 0.3f, 0.4f};
    whole.points += count;
    return writer.add(entry);
}

/// Whether a cache has synthetic surfels, and how they are stored.
enum class Filled { no, raw, coded };

/// Appends synthetic surfels, spread over the root cube.
Result<FillingSection> fill(CacheWriter& writer, const SourceHeader& header, bool coded) {
    constexpr uint32_t kCount = 24;
    FillingSection section{.schema = filling_schema(header.root), .points = kCount};
    const uint32_t stride = section.schema.stride;
    std::vector<std::byte> payload, records(size_t{kCount} * stride, std::byte{64});
    for (uint32_t i = 0; i < kCount; ++i)
        for (size_t axis = 0; axis < 3; ++axis)
            io::store(&records[i * stride + 4 * axis],
                      static_cast<int32_t>((i + 0.5) / kCount * 0x1p32 - 0x1p31));
    if (coded) {
        codec::PayloadEncoder(section.schema).encode(records, std::vector<uint8_t>(kCount, 0), payload);
        section.codec = format::kCodecColumns;
    } else {
        payload = records;
    }
    section.bytes = payload.size();
    section.checksum = format::checksum(payload);
    LUCARNE_ASSIGN(section.offset, writer.append(payload));
    return section;
}

Result<void> write(const std::filesystem::path& path, Filled filled) {
    SourceHeader whole = header();
    LUCARNE_ASSIGN(auto writer, CacheWriter::create(path, true, path.parent_path()));
    const NodeKey root, six = root.child(6);
    LUCARNE_TRY(add_node(writer, whole, root.child(1), 0, 2, 0));
    LUCARNE_TRY(add_node(writer, whole, six.child(3), 0, 3, 0));
    LUCARNE_TRY(add_node(writer, whole, six, 1 << 3, 2, 3));
    LUCARNE_TRY(add_node(writer, whole, root, 1 << 1 | 1 << 6, 4, 7));
    if (filled != Filled::no) {
        LUCARNE_ASSIGN(whole.filling, fill(writer, whole, filled == Filled::coded));
    }
    return writer.finish(whole);
}

/// Writes 17 nodes, whose directory has three pages.
Result<void> write_pages(const std::filesystem::path& path) {
    SourceHeader whole = header();
    LUCARNE_ASSIGN(auto writer, CacheWriter::create(path, true, path.parent_path()));
    const NodeKey root, six = root.child(6);
    for (uint32_t octant = 0; octant < 8; ++octant) {
        if (octant != 6) {
            LUCARNE_TRY(add_node(writer, whole, root.child(octant), 0, 1, 0));
            continue;
        }
        for (uint32_t below = 0; below < 8; ++below)
            LUCARNE_TRY(add_node(writer, whole, six.child(below), 0, 1, 0));
        LUCARNE_TRY(add_node(writer, whole, six, 255, 1, 8));
    }
    LUCARNE_TRY(add_node(writer, whole, root, 255, 1, 16));
    return writer.finish(whole, {format::kLeastPageNodes, 1});
}

}  // namespace
}  // namespace lucarne::octree

void lucarne::fuzz::cache_seeds(const Seeds& seeds) {
    using octree::Filled;
    const auto keep = [&](const std::string& name, const auto& write) {
        const auto path = seeds.folder() / fmt::format("{}.luc", name);
        const Result<void> written = write(path);
        if (!written) throw std::runtime_error(written.error().line());
        const auto verified = octree::verify_cache(path, [](uint64_t) {});
        if (!verified) throw std::runtime_error(verified.error().line());
        std::string bytes = Seeds::taken(path);
        bytes.erase(88, octree::format::kFirstPayload - 88);
        seeds.add(name, bytes);
    };
    for (const auto& [name, filled] :
         {std::pair{"levels", Filled::no}, {"filled", Filled::raw}, {"filled-coded", Filled::coded}})
        keep(name, [how = filled](const auto& path) { return octree::write(path, how); });
    keep("pages", octree::write_pages);
}
