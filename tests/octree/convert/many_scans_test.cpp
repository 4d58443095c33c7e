// Caches of more scans than 16 bits can number.
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "octree/cache/cache.h"
#include "octree/cache/file.h"
#include "octree/convert/build.h"
#include "octree/edit/edit.h"
#include "octree/tree/scan_number.h"
#include "tests/octree/convert/catalogue.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using test::ComputedSource;

/// One point a scan, whose attribute `number` is that of the scan.
std::vector<std::unique_ptr<ComputedSource>> scans_of_one_point(uint32_t count) {
    io::Schema schema;
    schema.add("number", io::ScalarType::u32);
    std::vector<std::unique_ptr<ComputedSource>> scans;
    for (uint32_t scan = 0; scan < count; ++scan) {
        scans.push_back(std::make_unique<ComputedSource>(schema, 1, [scan](uint64_t, std::byte* record) {
            io::store(record, double(scan % 256));
            io::store(record + 8, double(scan / 256));
            io::store(record + 16, 0.0);
            io::store(record + 24, scan);
        }));
        scans.back()->info().path = std::to_string(scan) + ".las";
    }
    return scans;
}

/// Expects that every point of a cache has the number of its scan, and that the versions in both superblocks
/// tell readers how wide it is.
void expect_numbered(const std::filesystem::path& path, uint64_t points, io::ScalarType type) {
    const auto cache = open_cache(path).value();
    const io::Schema& schema = cache->header().schema;
    EXPECT_EQ(schema.find(io::names::scan)->type, type);
    const auto blocks = read_superblocks(*InputFile::open(path)).value();
    for (const auto& block : blocks) EXPECT_EQ(block.value().version, type == io::ScalarType::u32 ? 3u : 2u);
    const ScanNumber scan(schema);
    uint64_t seen = 0;
    for (uint32_t node = 0; node < cache->nodes().size(); ++node) {
        const NodeData data = cache->load(node).value();
        for (size_t i = 0; i < data.count; ++i, ++seen) {
            const std::byte* record = &data.records[i * schema.stride];
            ASSERT_EQ(scan.of(record), io::load<uint32_t>(record + schema.find("number")->offset));
        }
    }
    EXPECT_EQ(seen, points);
}

TEST(ManyScans, AreNumberedWith16BitsAsFarAsTheseReachAndThenWith32) {
    const test::TempFolder folder;
    const auto all = scans_of_one_point(65'538);
    for (const size_t count : {size_t{65'535}, size_t{65'536}}) {
        BuildOptions options;
        for (size_t i = 0; i < count; ++i) options.inputs.push_back(all[i].get());
        options.output = folder / "a.luc";
        options.overwrite = true;
        options.normals = NormalsMode::none;
        options.fill = false;
        ASSERT_TRUE(build_cache(options));
        expect_numbered(options.output, count,
                        count > kMostShortScans ? io::ScalarType::u32 : io::ScalarType::u16);
        // Further scans make the numbers of a cache wider where they must, and leave them as wide.
        const EditOptions edit{.cache = options.output};
        ASSERT_TRUE(append_to_cache({all[count].get()}, edit));
        expect_numbered(options.output, count + 1, io::ScalarType::u32);
    }
}

TEST(ManyScans, OfMoreThanACacheCanListAreRefusedBeforeAnyIsRead) {
    const test::Catalogue catalogue(2, 1);
    const std::vector<const io::PointSource*> inputs(kMostScans + 1, catalogue.tiles[0].get());
    const auto refused = Unifier::create(inputs);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ErrorKind::arguments);
}

TEST(Catalogue, OfHeadersIsPlannedAndDividedWithoutReadingPoints) {
    const test::Catalogue catalogue(900, 10'000'000);
    const auto planned = test::plan(catalogue, 16, uint64_t{256} << 20);
    ASSERT_TRUE(planned) << planned.error().line();
    EXPECT_EQ(planned->points, catalogue.points);
    EXPECT_GE(planned->chunks, catalogue.points / 1'000'000);
    EXPECT_LT(planned->chunks, catalogue.points / 100'000);
    EXPECT_LT(planned->most_points_of_rank, catalogue.points / 16 + 2'000'000);
}

}  // namespace
}  // namespace lucarne::octree
