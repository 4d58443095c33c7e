// Caches written as COPC and read back by our own reader. For other tools see tests/oracles/copc_written.py.
#include <gmock/gmock.h>

#include "io/core/random.h"
#include "io/formats/copc/copc.h"
#include "io/formats/scan.h"
#include "octree/convert/build.h"
#include "octree/export/export.h"
#include "octree/open.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using test::TempFolder;

/// Points that always fill only a corner of the last octant: many levels, few nodes.
test::ComputedSource spiral(uint64_t points) {
    io::Schema schema;
    schema.position = io::PositionType::i32_scaled;
    schema.scale = glm::dvec3(0.001);
    schema.offset = glm::dvec3(2'600'000, 1'200'000, 400);  // Swiss: LV95
    schema.stride = 12;
    schema.add("intensity", io::ScalarType::u16);
    schema.add("gps_time", io::ScalarType::f64);
    schema.add("color", io::ScalarType::u16, 3);
    return {schema, points, [schema](uint64_t index, std::byte* record) {
                Random random(7, index);
                const double reach = std::exp2(-14 * random.uniform());
                for (size_t axis = 0; axis < 3; ++axis)
                    io::store(record + 4 * axis, static_cast<int32_t>(1e9 * (1 - reach * random.uniform())));
                io::store(record + schema.attributes[0].offset, static_cast<uint16_t>(index));
                io::store(record + schema.attributes[1].offset, 0.25 * static_cast<double>(index));
                io::store(record + schema.attributes[2].offset + 2, static_cast<uint16_t>(index >> 3));
            }};
}

class CopcExport : public ::testing::Test {
 protected:
    /// Builds `cache_` and writes it as `copc_`.
    void write(const io::PointSource& source) {
        BuildOptions options{.inputs = {&source}, .output = folder_ / "a.luc", .normals = NormalsMode::none};
        const auto built = build_cache(options);
        ASSERT_TRUE(built) << built.error().line();
        auto cache = open_octree(folder_ / "a.luc");
        ASSERT_TRUE(cache) << cache.error().line();
        cache_ = std::move(*cache);
        uint64_t told = 0;
        const auto written =
            Exporter(*cache_, {}).write_copc(folder_ / "a.copc.laz", false, [&](uint64_t points) {
                told += points;
            });
        ASSERT_TRUE(written) << written.error().line();
        EXPECT_EQ(told, cache_->header().points);
        auto copc = open_octree(folder_ / "a.copc.laz");
        ASSERT_TRUE(copc) << copc.error().line();
        copc_ = std::move(*copc);
    }

    const TempFolder folder_;
    std::unique_ptr<NodeSource> cache_, copc_;
};

TEST_F(CopcExport, ItsNodesAreThoseOfTheCacheWithTheirPointsOnSeveralPages) {
    write(spiral(300'000));
    const auto was = cache_->nodes(), is = copc_->nodes();
    ASSERT_EQ(is.size(), was.size());
    EXPECT_GT(was.back().key.level, 8u) << "no more than two pages of hierarchy";
    const auto positions = [](const NodeSource& source, uint32_t node) {
        std::vector<std::string> all;
        const auto data = source.load(node);
        const uint32_t stride = source.header().schema.stride;
        for (size_t i = 0; data && i < data->count; ++i)
            all.emplace_back(reinterpret_cast<const char*>(&data->records[i * stride]), 12);
        std::sort(all.begin(), all.end());
        return all;
    };
    for (uint32_t i = 0; i < was.size(); ++i) {
        EXPECT_EQ(is[i].key, was[i].key);
        EXPECT_EQ(is[i].count, was[i].count);
        EXPECT_EQ(is[i].subtree_count, was[i].subtree_count);
        EXPECT_EQ(is[i].child_mask, was[i].child_mask);
        EXPECT_EQ(is[i].first_child, was[i].first_child);
        ASSERT_TRUE(positions(*copc_, i) == positions(*cache_, i)) << "node " << i;
    }
    EXPECT_EQ(copc_->header().min, cache_->header().min);
    EXPECT_EQ(copc_->header().max, cache_->header().max);
    const auto file = io::copc::File::open(InputFile::open_shared(folder_ / "a.copc.laz").value());
    ASSERT_TRUE(file) << file.error().line();
    EXPECT_EQ(file->info().gps_low, 0.0);
    EXPECT_EQ(file->info().gps_high, 0.25 * 299'999);
    EXPECT_DOUBLE_EQ(file->info().spacing, cache_->header().root.size / 128);
}

TEST_F(CopcExport, EveryAttributeComesBackThroughTheLazReader) {
    const auto source = spiral(60'000);
    write(source);
    const auto laz = io::open_scan(folder_ / "a.copc.laz");
    ASSERT_TRUE(laz) << laz.error().line();
    const auto read = io::testing::read_all(**laz);
    ASSERT_TRUE(read) << read.error().line();
    const io::Schema &is = (*laz)->schema(), &was = source.schema();
    EXPECT_EQ(is.offset, was.offset);
    const auto rows = [&](const io::Schema& schema, const std::byte* records, size_t count) {
        std::vector<std::string> all;
        for (size_t i = 0; i < count; ++i, records += schema.stride) {
            std::string row(reinterpret_cast<const char*>(records), 12);
            for (const auto& a : was.attributes) {
                const auto* at = schema.find(a.name);
                row.append(reinterpret_cast<const char*>(records + at->offset), at->bytes());
            }
            all.push_back(std::move(row));
        }
        std::sort(all.begin(), all.end());
        return all;
    };
    std::vector<std::byte> input(source.points() * was.stride);
    io::PointBatch batch;
    const auto reader = source.open();
    for (size_t at = 0; (*reader)->read(batch, 10'000).value_or(0) > 0; at += batch.count * was.stride)
        std::copy(batch.bytes.begin(), batch.bytes.end(), input.begin() + static_cast<std::ptrdiff_t>(at));
    EXPECT_TRUE(rows(is, read->bytes.data(), read->count) == rows(was, input.data(), source.points()));
}

TEST_F(CopcExport, NodesThatDivideOnePlaceBecomeOne) {
    io::Schema schema;
    schema.position = io::PositionType::i32_scaled;
    schema.scale = glm::dvec3(0.01);
    schema.stride = 12;
    schema.add("intensity", io::ScalarType::u16);
    write(test::ComputedSource(schema, 30'000, [&](uint64_t index, std::byte* record) {
        for (size_t axis = 0; axis < 3; ++axis)
            io::store(record + 4 * axis, index ? 5 : 1'000'000);  // all but one at one place
        io::store(record + 12, static_cast<uint16_t>(index));
    }));
    EXPECT_GT(cache_->nodes().back().key.level, kMaxLevel);
    EXPECT_LE(copc_->nodes().back().key.level, kMaxLevel);
    EXPECT_EQ(copc_->header().points, 30'000u);
    EXPECT_EQ(test::sorted_records(*copc_, 12).size(), 30'000u);
}

}  // namespace
}  // namespace lucarne::octree
