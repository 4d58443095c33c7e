#include "octree/build/build.h"

#include <cmath>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "io/core/random.h"
#include "octree/cache.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using test::ComputedSource;
using test::TempFolder;

/// A LAS-like schema: 12 bytes of position, colour, intensity.
io::Schema las_like() {
    io::Schema schema;
    schema.position = io::PositionType::i32_scaled;
    schema.scale = glm::dvec3(0.001);
    schema.offset = glm::dvec3(4.0e5, 5.0e6, 100.0);
    schema.stride = 12;
    schema.add("color", io::ScalarType::u16, 3);
    schema.add("intensity", io::ScalarType::u16);
    return schema;
}

/// A rough hemisphere over a floor, 20 m wide, uneven density, every attribute different for every point.
ComputedSource hall(uint64_t points, uint64_t seed = 1) {
    return {las_like(), points, [seed](uint64_t index, std::byte* record) {
                Random random(seed, index);
                glm::dvec3 p;
                const double angle = 6.283185307 * random.uniform(), r = random.uniform() * random.uniform();
                if (index % 3 == 0) {
                    p = {10 * r * std::cos(angle), 10 * r * std::sin(angle), 0.002 * random.uniform()};
                } else {
                    const double z = random.uniform();
                    p = 10.0 * glm::dvec3(std::sqrt(1 - z * z) * std::cos(angle),
                                          std::sqrt(1 - z * z) * std::sin(angle), z);
                }
                for (int axis = 0; axis < 3; ++axis)
                    io::store(record + 4 * axis, static_cast<int32_t>(std::lround(p[axis] * 1000)));
                io::store(record + 12, random.next());
            }};
}

Result<BuildReport> build(const io::PointSource& source, const std::filesystem::path& output,
                          uint64_t memory = uint64_t{1} << 30, unsigned threads = 2) {
    BuildOptions options;
    options.inputs = {&source};
    options.output = output;
    options.normals = NormalsMode::none;
    options.memory = memory;
    options.threads = threads;
    return build_cache(options);
}

std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Build, KeepsEveryPointExactlyOnce) {
    const TempFolder folder;
    const auto source = hall(200'000);
    const auto report = build(source, folder / "a.luc");
    ASSERT_TRUE(report) << report.error().line();
    EXPECT_EQ(report->points, 200'000u);
    const auto verified = verify_cache(folder / "a.luc", [](uint64_t) {});
    ASSERT_TRUE(verified) << verified.error().line();
    EXPECT_EQ(verified->points, 200'000u);
    EXPECT_GT(verified->nodes, 20u);
    const auto cache = open_cache(folder / "a.luc");
    ASSERT_TRUE(cache) << cache.error().line();
    EXPECT_EQ(test::sorted_records(**cache, 20), test::sorted_records(source, 20));
}

TEST(Build, IsTheSameFileForAnyThreadsBatchesAndMemory) {
    const TempFolder folder;
    auto source = hall(300'000);
    ASSERT_TRUE(build(source, folder / "reference.luc", uint64_t{1} << 30, 1));
    const std::string reference = bytes_of(folder / "reference.luc");
    struct Case {
        uint64_t memory;
        unsigned threads;
        size_t batch;
    };
    for (const auto& [memory, threads, batch] :
         {Case{uint64_t{1} << 30, 2, 1000}, Case{uint64_t{1} << 30, 4, 77}, Case{uint64_t{16} << 20, 1, 5000},
          Case{uint64_t{64} << 20, 4, 100'000}}) {
        source.limit_batches(batch);
        const auto name = folder / (std::to_string(memory >> 20) + "-" + std::to_string(threads));
        const auto report = build(source, name, memory, threads);
        ASSERT_TRUE(report) << report.error().line();
        EXPECT_TRUE(bytes_of(name) == reference)
            << memory << " bytes, " << threads << " threads, " << report->chunks << " chunks";
    }
}

}  // namespace
}  // namespace lucarne::octree
