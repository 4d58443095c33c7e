// More points than 32 bits can count, wherever points are counted. The points themselves are never made.
#include <fstream>

#include <gtest/gtest.h>

#include "octree/cache/cache.h"
#include "octree/cache/format.h"
#include "octree/cache/metadata.h"
#include "octree/convert/chunks/chunk_plan.h"
#include "octree/stream/cut.h"
#include "tests/octree/plane_source.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

constexpr uint64_t k32Bits = uint64_t{1} << 32;

TEST(LargeCounts, ChunksOfTwentyBillionPointsFollowOneAnother) {
    CountGrid grid({}, 20 * uint64_t{1'000'000'000}, uint64_t{1} << 20);
    for (uint32_t i = 0; i < 10; ++i)
        grid.count({i * 400'000'000u, 1, 1}, i == 7 ? 2 * k32Bits : 1'000'000'000);
    const auto chunks = grid.plan(3'000'000'000, 1000);
    uint64_t sum = 0;
    bool dense = false;
    for (const Chunk& chunk : chunks) {
        EXPECT_EQ(chunk.first, sum);
        sum += chunk.count;
        dense |= chunk.count == 2 * k32Bits;
        EXPECT_TRUE(chunk.count <= 3'000'000'000 || chunk.count == 2 * k32Bits);
    }
    EXPECT_TRUE(dense);
    EXPECT_EQ(sum, 9'000'000'000 + 2 * k32Bits);
}

TEST(LargeCounts, APlaceIsDividedWithoutALossOrAnOverlap) {
    for (const uint64_t count : {k32Bits * 5 + 3, uint64_t{7}, UINT64_MAX}) {
        EXPECT_EQ(stacked_first(count, 0), 0u);
        EXPECT_EQ(stacked_first(count, 8), count);
        for (uint32_t octant = 0; octant < 8; ++octant) {
            const uint64_t part = stacked_first(count, octant + 1) - stacked_first(count, octant);
            EXPECT_TRUE(part == count / 8 || part == count / 8 + 1);
        }
    }
}

TEST(LargeCounts, CutsOfFiveBillionPoints) {
    const test::PlaneSource source(11, 4000, 10000.0);
    ASSERT_GT(source.header().points, k32Bits);
    const Cut full = full_cut(source);
    EXPECT_EQ(full.points, source.header().points);
    const uint64_t budget = k32Bits + 1'000'000'000;
    const Cut light = light_cut(source, {5000, 5000, 10}, budget);
    EXPECT_GT(light.points, k32Bits);
    EXPECT_LE(light.points, budget);
}

/// Seventeen nodes of 350 million points. The file has 71 GB, but its points are a hole, so it takes only a
/// few blocks on disk.
TEST(LargeCounts, ACacheOfMoreThanFourBillionPointsOpensAndCounts) {
    const lucarne::test::TempFolder folder;
    constexpr uint32_t kPoints = 350'000'000, kChildren = 8, kGrandchildren = 8;
    SourceHeader header;
    header.schema.position = io::PositionType::f32;
    header.schema.stride = 12;
    header.root = {glm::dvec3(0), 1.0};
    header.max = glm::dvec3(1);
    const uint64_t nodes = 1 + kChildren + kGrandchildren;
    header.points = nodes * kPoints;
    ASSERT_GT(header.points, k32Bits);
    std::vector<format::Entry> entries(nodes);
    for (uint32_t i = 0; i < nodes; ++i) {
        format::Entry& entry = entries[i];
        entry.key = i == 0           ? NodeKey{}
                    : i <= kChildren ? NodeKey{}.child(i - 1)
                                     : NodeKey{}.child(0).child(i - 9);
        entry.child_mask = i < 2 ? 255 : 0;
        entry.count = kPoints;
        entry.subtree_count = (i == 0 ? nodes : i == 1 ? 1 + kGrandchildren : 1) * uint64_t{kPoints};
        entry.payload_bytes = kPoints * 12;
        entry.payload_offset = format::kFirstPayload + i * uint64_t{entry.payload_bytes};
        entry.area_floor.fill(1e-9f);
    }
    std::vector<std::byte> directory(nodes * format::kEntryBytes);
    for (size_t i = 0; i < nodes; ++i) format::store_entry(entries[i], &directory[i * format::kEntryBytes]);
    const std::string metadata = metadata_text(header);
    format::Superblock block;
    block.generation = 1;
    block.directory_offset = entries.back().payload_offset + entries.back().payload_bytes;
    block.directory_bytes = directory.size();
    block.directory_checksum = format::checksum(directory);
    block.metadata_offset = block.directory_offset + directory.size();
    block.metadata_bytes = metadata.size();
    block.metadata_checksum = format::checksum(std::as_bytes(std::span(metadata)));
    block.file_bytes = block.metadata_offset + metadata.size();
    const auto superblock = format::encode(block);
    std::ofstream out(folder / "sparse.luc", std::ios::binary);
    const auto put = [&](uint64_t at, std::span<const std::byte> bytes) {
        out.seekp(static_cast<std::streamoff>(at));
        out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    };
    put(0, superblock);
    put(format::kSuperblockBytes, superblock);
    put(block.directory_offset, directory);
    put(block.metadata_offset, std::as_bytes(std::span(metadata)));
    out.close();
    if (!out) GTEST_SKIP() << "this file system holds no sparse file of 71 GB";

    const auto cache = open_cache(folder / "sparse.luc");
    ASSERT_TRUE(cache) << cache.error().line();
    EXPECT_EQ((*cache)->header().points, nodes * kPoints);
    EXPECT_EQ(full_cut(**cache).points, nodes * kPoints);
    EXPECT_EQ((*cache)->nodes()[1].subtree_count, 9 * uint64_t{kPoints});
}

}  // namespace
}  // namespace lucarne::octree
