// Every byte of a cache is checked or has no meaning: verify ignores only the bytes that an update left
// behind.
#include <cstdio>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>

#include "io/core/random.h"
#include "octree/cache/cache.h"
#include "octree/cache/file.h"
#include "octree/convert/build.h"
#include "octree/edit/edit.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using test::ComputedSource;

ComputedSource scan(uint64_t points, uint64_t seed) {
    io::Schema schema;
    schema.add("classification", io::ScalarType::u8);
    schema.add(std::string(io::names::color), io::ScalarType::u16, 3);
    ComputedSource source(schema, points, [seed](uint64_t index, std::byte* record) {
        Random random(seed, index);
        io::store(record, glm::dvec3(random.uniform(), random.uniform(), .1 * static_cast<double>(seed)));
        for (size_t at = 24; at < 31; ++at) record[at] = static_cast<std::byte>(random.next());
    });
    source.info().path = "scan " + std::to_string(seed);
    return source;
}

ComputedSource described_scan() {
    ComputedSource source = scan(200, 4);
    auto& info = source.info();
    info.path = "Übersicht \xff.las";  // not UTF-8
    info.coordinate_system = "ETRS89 / UTM zone 32N";
    info.epsg = 25832;
    info.stations = {{1, {.5, .5, 2}}, {2, {.1, .9, 2}}};
    info.notes.ply = {{}, {""}, {}};
    info.losses = {{"points whose state is invalid", 12}};
    return source;
}

void build(std::vector<const io::PointSource*> inputs, const std::filesystem::path& output,
           NormalsMode normals) {
    BuildOptions options;
    options.inputs = std::move(inputs);
    options.output = output;
    options.normals = normals;
    options.threads = 1;
    const auto built = build_cache(options);
    ASSERT_TRUE(built) << built.error().line();
}

void append(const std::filesystem::path& cache, const io::PointSource& added) {
    const auto done = append_to_cache({&added}, {.cache = cache, .threads = 1});
    ASSERT_TRUE(done) << done.error().line();
}

void remove_points(const std::filesystem::path& cache) {
    const auto done = delete_from_cache({.box = Box{glm::dvec3(-1), glm::dvec3(.3, 2, 2)}, .scan = {}},
                                        {.cache = cache, .threads = 1});
    ASSERT_TRUE(done) << done.error().line();
}

struct Kind {
    const char* name;
    bool updated;  ///< updated in place: bytes are left behind
    std::function<void(const std::filesystem::path&)> make;
};

std::ostream& operator<<(std::ostream& out, const Kind& kind) {
    return out << kind.name;
}

const Kind kKinds[] = {
    {"Fresh", false,
     [](const auto& path) {
         const auto a = scan(200, 1);
         build({&a}, path, NormalsMode::none);
     }},
    {"WithNormals", false,
     [](const auto& path) {
         const auto a = scan(200, 1);
         build({&a}, path, NormalsMode::estimate);
     }},
    {"OfSeveralLevels", false,
     [](const auto& path) {
         const auto a = scan(11'000, 1);
         build({&a}, path, NormalsMode::none);
     }},
    {"OfSeveralScans", false,
     [](const auto& path) {
         const auto a = scan(200, 1), b = scan(100, 2);
         build({&a, &b}, path, NormalsMode::estimate);
     }},
    {"WithDescriptions", false,
     [](const auto& path) {
         const auto a = described_scan();
         build({&a}, path, NormalsMode::none);
     }},
    {"Appended", true,
     [](const auto& path) {
         const auto a = scan(200, 1), b = scan(100, 2), c = scan(50, 3);
         build({&a}, path, NormalsMode::estimate);
         append(path, b);
         append(path, c);
     }},
    {"Edited", true,
     [](const auto& path) {
         const auto a = scan(200, 1);
         build({&a}, path, NormalsMode::estimate);
         remove_points(path);
     }},
    {"Compacted", false,
     [](const auto& path) {
         const auto a = scan(200, 1), b = scan(100, 2);
         build({&a}, path, NormalsMode::estimate);
         append(path, b);
         remove_points(path);
         const auto done = compact_cache(path, {});
         ASSERT_TRUE(done) << done.error().line();
     }},
};

/// Marks the bytes that the newest state of a cache refers to.
std::vector<bool> named_bytes(const std::filesystem::path& path) {
    const auto cache = CacheFile::open(path).value();
    std::vector<bool> named(cache->file().size(), false);
    const auto name = [&](uint64_t offset, uint64_t bytes) {
        std::fill_n(named.begin() + static_cast<ptrdiff_t>(offset), bytes, true);
    };
    const auto& block = cache->superblock();
    name(0, format::kFirstPayload);
    name(block.metadata_offset, block.metadata_bytes);
    name(block.directory_offset, block.directory_bytes);
    for (uint32_t node = 0; node < cache->nodes().size(); ++node)
        name(cache->entry(node).payload_offset, cache->entry(node).payload_bytes);
    return named;
}

class FlippedByte : public ::testing::TestWithParam<Kind> {};

TEST_P(FlippedByte, IsFoundByVerifyWhereverTheCacheSpeaksOfIt) {
    const test::TempFolder folder;
    const auto path = folder / "cache.luc";
    GetParam().make(path);
    ASSERT_TRUE(verify_cache(path, [](uint64_t) {}));
    const auto named = named_bytes(path);
    const auto bytes = io::testing::read_bytes(path);
    ASSERT_EQ(named.size(), bytes.size());
    const size_t step = bytes.size() > 100'000 ? 7 : 1;
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    const auto put = [&](size_t at, char value) {
        file.seekp(static_cast<std::streamoff>(at)).put(value).flush();
    };
    size_t left_behind = 0;
    for (size_t at = 0; at < bytes.size(); at += step) {
        const auto flipped = static_cast<char>(bytes[at] ^ (1 << at % 8));
        put(at, flipped);
        const bool passes = verify_cache(path, [](uint64_t) {}).has_value();
        put(at, bytes[at]);
        ASSERT_EQ(passes, !named[at]) << "byte " << at;
        left_behind += !named[at];
    }
    EXPECT_EQ(left_behind > 0, GetParam().updated);
    EXPECT_TRUE(verify_cache(path, [](uint64_t) {}));
}

INSTANTIATE_TEST_SUITE_P(Caches, FlippedByte, ::testing::ValuesIn(kKinds),
                         [](const auto& named) { return std::string(named.param.name); });

}  // namespace
}  // namespace lucarne::octree
