#pragma once

#include <cmath>
#include <filesystem>
#include <functional>

#include "octree/cache/writer.h"

namespace lucarne::test {

/// Writes a cache of 10^11 points and more than 2^40 bytes, whose directory takes 36 MB. The points of the
/// root lie on the floor z = 0 of the unit cube; those of all other nodes are a hole in the file, so that it
/// takes little on the disk. Fails where the file system does not hold such a file.
inline Result<octree::SourceHeader> write_large_cache(const std::filesystem::path& path) {
    using namespace octree;
    constexpr uint32_t kSide = 418, kPoints = kSide * kSide, kLevels = 6;
    SourceHeader header;
    header.schema.position = io::PositionType::f32;
    header.schema.stride = 12;
    header.root = {glm::dvec3(0), 1.0};
    header.max = glm::dvec3(1);
    header.scans.resize(1);
    LUCARNE_ASSIGN(auto writer, CacheWriter::create(path, false, path.parent_path()));
    std::vector<std::byte> records(12 * size_t{kPoints});
    const uint64_t zeros = format::checksum(records);
    Result<void> added;
    const std::function<uint64_t(const NodeKey&)> add = [&](const NodeKey& key) {
        format::Entry entry{.key = key, .count = kPoints, .payload_bytes = kPoints * 12, .checksum = zeros};
        entry.subtree_count = kPoints;
        const bool parent = key.level < kLevels || (key.level == kLevels && (key.x & 1) == 0);
        for (uint32_t octant = 0; parent && octant < 8; ++octant)
            entry.subtree_count += add(key.child(octant));
        entry.child_mask = parent ? 255 : 0;
        entry.payload_offset = writer.reserve(key.level > 0 ? entry.payload_bytes : 0);
        entry.area_floor.fill(static_cast<float>(std::exp2(-2.0 * key.level) / kPoints));
        if (key.level == 0) {
            for (uint32_t i = 0; i < kPoints; ++i) {
                io::store(&records[12 * size_t{i}], (static_cast<float>(i % kSide) + .5f) / kSide);
                io::store(&records[12 * size_t{i} + 4], (static_cast<float>(i / kSide) + .5f) / kSide);
            }
            entry.checksum = format::checksum(records);
            if (added) added = writer.append(records).map([](uint64_t) {});
        }
        if (added) added = writer.add(entry);
        return entry.subtree_count;
    };
    header.points = add({});
    LUCARNE_TRY(added);
    LUCARNE_TRY(writer.finish(header));
    return header;
}

}  // namespace lucarne::test
