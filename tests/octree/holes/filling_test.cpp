// The section of a cache that holds synthetic surfels.
#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "io/formats/scan.h"
#include "io/synthetic/scene_geometry.h"
#include "io/synthetic/synthetic.h"
#include "octree/cache/cache.h"
#include "octree/cache/file.h"
#include "octree/convert/build.h"
#include "octree/edit/edit.h"
#include "octree/export/export.h"
#include "octree/stream/joined_source.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using std::filesystem::path;

std::string bytes_of(const path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

class FillingTest : public testing::Test {
 protected:
    path build(const std::string& name, bool fill, uint64_t seed = 1) const {
        io::SyntheticOptions scan;
        scan.points = 60'000;
        scan.seed = seed;
        const auto source = io::synthetic_source(scan);
        EXPECT_TRUE(source);
        BuildOptions options;
        options.inputs = {source->get()};
        options.output = folder_ / name;
        options.fill = fill;
        EXPECT_TRUE(build_cache(options));
        return options.output;
    }
    static std::unique_ptr<CacheFile> opened(const path& file) {
        auto cache = CacheFile::open(file);
        EXPECT_TRUE(cache) << cache.error().line();
        return std::move(*cache);
    }
    static bool is_sound(const path& file) {
        return verify_cache(file, [](uint64_t) {}).has_value();
    }
    static std::vector<glm::dvec3> places_of(const CacheFile& cache) {
        std::vector<glm::dvec3> places;
        const auto data = cache.load_filling();
        EXPECT_TRUE(data) << data.error().line();
        if (!data || data->count == 0) return places;
        const io::Schema& schema = cache.header().filling->schema;
        for (size_t i = 0; i < data->count; ++i)
            places.push_back(io::position_of(schema, &data->records[i * schema.stride]));
        return places;
    }

    const test::TempFolder folder_;
};

TEST_F(FillingTest, IsStoredBesideThePointsAndRestored) {
    const path filled = build("filled.luc", true), plain = build("plain.luc", false);
    const auto cache = opened(filled), without = opened(plain);
    EXPECT_TRUE(is_sound(filled));
    ASSERT_TRUE(cache->header().filling);
    EXPECT_FALSE(without->header().filling);
    EXPECT_EQ(cache->header().points, without->header().points);
    EXPECT_EQ(cache->nodes().size(), without->nodes().size());
    EXPECT_TRUE(without->fillings().value().empty());
    const auto places = places_of(*cache);
    EXPECT_GT(places.size(), 200u);
    EXPECT_LE(places.size(), cache->header().points / 16);
    EXPECT_EQ(places.size(), cache->header().filling->points);
    const auto truth = io::SceneGeometry::create("cornell").value();
    EXPECT_TRUE(
        std::ranges::all_of(places, [&](const auto& p) { return truth->closest(p, 0.05).has_value(); }));
    const auto fillings = cache->fillings().value();
    ASSERT_EQ(fillings.size(), 1u);
    uint64_t count = 0;
    for (size_t i = 0; i < fillings[0].nodes.size(); ++i) {
        EXPECT_EQ(fillings[0].nodes[i].count, fillings[0].records[i].count);
        count += fillings[0].nodes[i].count;
    }
    EXPECT_EQ(count, places.size());
}

TEST_F(FillingTest, IsNeverExported) {
    const auto exported = [&](const path& cache, const std::string& name) {
        const path output = folder_ / name;
        const auto source = opened(cache);
        const Exporter exporter(*source, {});
        const auto writer = io::create_scan(output, exporter.schema(), exporter.info(), {});
        EXPECT_TRUE(writer && exporter.write(**writer, [](uint64_t) {}));
        return bytes_of(output);
    };
    const path filled = build("filled.luc", true), plain = build("plain.luc", false);
    EXPECT_EQ(exported(filled, "a.las"), exported(plain, "b.las"));
}

/// Deleting the lower half of the box leaves no holes in the floor; appending makes them anew.
TEST_F(FillingTest, FollowsEveryUpdate) {
    const path file = build("cache.luc", true);
    const auto low = [](const glm::dvec3& p) { return p.z < 0.5; };
    ASSERT_TRUE(std::ranges::any_of(places_of(*opened(file)), low));
    const std::string before = bytes_of(file);
    ASSERT_TRUE(compact_cache(file, {}));
    EXPECT_EQ(bytes_of(file), before);
    Selection selection;
    selection.box = Box{glm::dvec3(-100, -100, -100), glm::dvec3(100, 100, 0.5)};
    ASSERT_TRUE(delete_from_cache(selection, {.cache = file}));
    EXPECT_TRUE(is_sound(file));
    EXPECT_TRUE(std::ranges::none_of(places_of(*opened(file)), low));
    io::SyntheticOptions scan;
    scan.points = 60'000;
    scan.seed = 2;
    const auto source = io::synthetic_source(scan).value();
    ASSERT_TRUE(append_to_cache({source.get()}, {.cache = file}));
    EXPECT_TRUE(is_sound(file));
    EXPECT_TRUE(std::ranges::any_of(places_of(*opened(file)), low));
    ASSERT_TRUE(compact_cache(file, {}));
    EXPECT_TRUE(is_sound(file));
    EXPECT_TRUE(std::ranges::any_of(places_of(*opened(file)), low));

    const path plain = build("plain.luc", false);
    ASSERT_TRUE(append_to_cache({source.get()}, {.cache = plain}));
    EXPECT_FALSE(opened(plain)->header().filling) << "--no-fill holds for what is appended, too";
}

TEST_F(FillingTest, DamageIsFound) {
    const path file = build("cache.luc", true);
    const std::string bytes = bytes_of(file);
    const FillingSection section = *opened(file)->header().filling;
    const auto write = [&](const std::string& changed) {
        const path name = folder_ / "damaged.luc";
        std::ofstream(name, std::ios::binary)
            .write(changed.data(), static_cast<std::streamsize>(changed.size()));
        return name;
    };
    for (uint64_t at = 0; at < section.bytes; at += section.bytes / 50 + 1) {
        std::string changed = bytes;
        changed[section.offset + at] ^= 1;
        const path name = write(changed);
        EXPECT_FALSE(is_sound(name));
        EXPECT_FALSE(opened(name)->fillings());
    }
    // False contents with correct checksums.
    const auto block = *format::decode(std::as_bytes(std::span(bytes)).first<format::kSuperblockBytes>());
    const auto with_metadata = [&](const std::string& from, std::string to) {
        std::string changed = bytes;
        const size_t begin = changed.find("\"filling\"", block.metadata_offset),
                     at = changed.find(from, begin);
        EXPECT_NE(at, std::string::npos) << from;
        to.resize(from.size(), ' ');
        changed.replace(at, to.size(), to);
        format::Superblock forged = block;
        forged.metadata_checksum = format::checksum(
            std::as_bytes(std::span(changed)).subspan(block.metadata_offset, block.metadata_bytes));
        const auto encoded = format::encode(forged);
        std::memcpy(changed.data(), encoded.data(), encoded.size());
        std::memcpy(changed.data() + format::kSuperblockBytes, encoded.data(), encoded.size());
        return write(changed);
    };
    const std::string offset = "\"offset\": " + std::to_string(section.offset),
                      points = "\"points\": " + std::to_string(section.points),
                      size = "\"bytes\": " + std::to_string(section.bytes);
    EXPECT_TRUE(CacheFile::open(with_metadata(points, points)));
    EXPECT_FALSE(CacheFile::open(with_metadata(offset, "\"offset\": 9"))) << "a superblock";
    EXPECT_FALSE(CacheFile::open(with_metadata(offset, "\"offset\": 8192"))) << "another node's points";
    EXPECT_FALSE(CacheFile::open(with_metadata(size, "\"bytes\": 1e9")));
    EXPECT_FALSE(CacheFile::open(with_metadata(points, "\"points\": -1")));
    EXPECT_FALSE(CacheFile::open(with_metadata(points, "\"points\": 9e9")));
    EXPECT_FALSE(CacheFile::open(with_metadata("\"codec\": 1", "\"codec\": 0")));
    EXPECT_FALSE(CacheFile::open(with_metadata("\"i32_scaled\"", "\"f64\"")));
    // A wrong number of surfels that the payload's size allows.
    const auto fewer =
        CacheFile::open(with_metadata(points, "\"points\": " + std::to_string(section.points - 1)));
    ASSERT_TRUE(fewer);
    EXPECT_FALSE((*fewer)->fillings());
    EXPECT_TRUE(CacheFile::open(with_metadata("\"filling\"", "\"fillers\"")))
        << "unknown members are ignored";
}

/// Two caches in one source keep their own fillings, units included.
TEST_F(FillingTest, IsKnownOfJoinedSources) {
    const std::shared_ptr<const NodeSource> a = opened(build("a.luc", true)),
                                            b = opened(build("b.luc", true, 2));
    const auto joined = join_sources({a, b}).value();
    const auto fillings = joined->fillings().value();
    ASSERT_EQ(fillings.size(), 2u);
    EXPECT_EQ(fillings[0].part, 0u);
    EXPECT_EQ(fillings[1].part, 1u);
    EXPECT_EQ(joined->header().points, a->header().points + b->header().points);
}

}  // namespace
}  // namespace lucarne::octree
