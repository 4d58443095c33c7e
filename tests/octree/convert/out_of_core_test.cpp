// A cloud a hundred times larger than --memory, made while it is read. The kernel measures the resident
// memory.
#include <cmath>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>

#include "io/core/options.h"
#include "io/core/random.h"
#include "io/formats/scan.h"
#include "octree/cache/cache.h"
#include "octree/convert/build.h"
#include "tests/octree/test_sources.h"

extern char** environ;

namespace lucarne::octree {
namespace {

constexpr uint64_t kMemory = uint64_t{16} << 20;
/// Memory that does not belong to any stage: the allocator's reserve, thread stacks and tables.
constexpr uint64_t kSlack = uint64_t{4} << 20;

/// Ten rooms of walls and floors. Each point has doubles for everything: 80 bytes.
test::ComputedSource rooms(uint64_t points) {
    io::Schema schema;
    for (const char* name :
         {"gps_time", "range", "azimuth", "elevation", "amplitude", "deviation", "reflectance"})
        schema.add(name, io::ScalarType::f64);
    return {schema, points, [](uint64_t index, std::byte* record) {
                Random random(5, index);
                const double u = random.uniform(), v = random.uniform(),
                             room = static_cast<double>(index % 10);
                glm::dvec3 p(8 * u, 8 * v, 0);
                if (index % 3 == 1) p = {8 * u, 0, 4 * v};
                if (index % 3 == 2) p = {0, 8 * u, 4 * v};
                io::store(record, p + glm::dvec3(9 * room + 3e5, 5e6, 0.001 * random.uniform()));
                for (size_t i = 0; i < 7; ++i)
                    io::store(record + 24 + 8 * i, static_cast<double>(index) + 0.1 * static_cast<double>(i));
            }};
}

/// The most memory that this process ever had resident, bytes.
uint64_t peak_resident() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind("VmHWM:", 0) == 0) return std::stoull(line.substr(6)) << 10;
    return 0;
}

/// Not a test, but what the measured process runs. Builds LUCARNE_TEST_POINTS points and writes its peak to a
/// file beside the cache.
TEST(OutOfCore, DISABLED_BuildAndWriteDownThePeak) {
    const char* points = std::getenv("LUCARNE_TEST_POINTS");
    const char* output = std::getenv("LUCARNE_TEST_OUTPUT");
    const char* memory = std::getenv("LUCARNE_TEST_NORMALS_MEMORY");
    if (!points || !output) GTEST_SKIP() << "run by the test below";
    const auto source = rooms(std::stoull(points));
    const char* scan = std::getenv("LUCARNE_TEST_SCAN");
    const auto opened = scan ? io::open_scan(scan).value() : nullptr;
    BuildOptions options;
    options.inputs = {opened ? opened.get() : &source};
    options.output = output;
    options.normals = memory ? NormalsMode::estimate : NormalsMode::none;
    options.memory = memory ? std::stoull(memory) : kMemory;
    const auto report = build_cache(options);
    ASSERT_TRUE(report) << report.error().line();
    std::ofstream(std::string(output) + ".peak") << peak_resident() << " " << report->chunks;
}

struct Measured {
    uint64_t peak = 0, chunks = 0;
};

/// Returns the peak of a process that only builds, so that memory freed by earlier tests does not count.
Measured build_in_child(const std::filesystem::path& output, uint64_t points) {
    ::setenv("LUCARNE_TEST_POINTS", std::to_string(points).c_str(), 1);
    ::setenv("LUCARNE_TEST_OUTPUT", output.c_str(), 1);
    std::string program = std::filesystem::read_symlink("/proc/self/exe"),
                filter = "--gtest_filter=OutOfCore.DISABLED_*", all = "--gtest_also_run_disabled_tests",
                brief = "--gtest_brief=1";
    char* arguments[] = {program.data(), filter.data(), all.data(), brief.data(), nullptr};
    pid_t child = 0;
    int status = -1;
    if (::posix_spawn(&child, program.c_str(), nullptr, nullptr, arguments, environ) == 0)
        ::waitpid(child, &status, 0);
    ::unsetenv("LUCARNE_TEST_POINTS");
    Measured run;
    std::ifstream(output.string() + ".peak") >> run.peak >> run.chunks;
    EXPECT_EQ(status, 0);
    return run;
}

TEST(OutOfCore, StaysUnderTheMemoryCapForAHundredTimesAsMuchInput) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "AddressSanitizer's own memory hides the program's";
#endif
    const uint64_t points = 100 * kMemory / 80 + 1;
    const test::TempFolder folder;
    const Measured base = build_in_child(folder / "tiny.luc", 1000);
    const Measured full = build_in_child(folder / "large.luc", points);
    ASSERT_GT(base.peak, 0u);
    const uint64_t held = full.peak - std::min(full.peak, base.peak);
    std::printf("%s of points in %lu chunks: %s resident, %s of it for an empty process; the cap is %s\n",
                bytes_text(points * 80).c_str(), full.chunks, bytes_text(full.peak).c_str(),
                bytes_text(base.peak).c_str(), bytes_text(kMemory).c_str());
    EXPECT_LE(held, kMemory + kSlack);
    EXPECT_GT(full.chunks, 50u);
    const auto cache = open_cache(folder / "large.luc");
    ASSERT_TRUE(cache) << cache.error().line();
    EXPECT_EQ((*cache)->header().points, points);
}

TEST(OutOfCore, StaysUnderTheMemoryCapWithNormals) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "AddressSanitizer's own memory hides the program's";
#endif
    const test::TempFolder folder;
    const uint64_t points = 2'000'000;
    for (const uint64_t memory : {uint64_t{16} << 20, uint64_t{32} << 20, uint64_t{64} << 20}) {
        ::setenv("LUCARNE_TEST_NORMALS_MEMORY", std::to_string(memory).c_str(), 1);
        const Measured base = build_in_child(folder / fmt::format("tiny-{}.luc", memory), 1000);
        const Measured full = build_in_child(folder / fmt::format("large-{}.luc", memory), points);
        ::unsetenv("LUCARNE_TEST_NORMALS_MEMORY");
        ASSERT_GT(base.peak, 0u);
        const uint64_t held = full.peak - std::min(full.peak, base.peak);
        std::printf("%s of points in %lu chunks: %s resident, %s of it for an empty process; the cap is %s\n",
                    bytes_text(points * 80).c_str(), full.chunks, bytes_text(full.peak).c_str(),
                    bytes_text(base.peak).c_str(), bytes_text(memory).c_str());
        EXPECT_LE(held, memory + kSlack);
        EXPECT_GT(full.chunks, 10u);
    }
}

TEST(OutOfCore, StaysUnderTheMemoryCapWhileItReadsLaz) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "AddressSanitizer's own memory hides the program's";
#endif
    const test::TempFolder folder;
    const auto scan = folder / "rooms.laz";
    {
        const auto source = rooms(600'000);
        io::WriteOptions options;
        options.bounds = std::array{glm::dvec3(3e5, 5e6, 0), glm::dvec3(3e5 + 100, 5e6 + 10, 5)};
        const auto writer = io::create_scan(scan, source.schema(), source.info(), options);
        ASSERT_TRUE(writer) << writer.error().line();
        const auto reader = source.open();
        io::PointBatch batch;
        while ((*reader)->read(batch, 50'000).value_or(0) > 0) {
            const auto written = (*writer)->write(batch.bytes);
            ASSERT_TRUE(written) << written.error().line();
        }
        ASSERT_TRUE((*writer)->finish());
    }
    const Measured base = build_in_child(folder / "tiny.luc", 1000);
    ::setenv("LUCARNE_TEST_SCAN", scan.c_str(), 1);
    const Measured full = build_in_child(folder / "laz.luc", 1);
    ::unsetenv("LUCARNE_TEST_SCAN");
    const uint64_t held = full.peak - std::min(full.peak, base.peak);
    std::printf("LAZ: %s resident, %s of it for an empty process; the cap is %s\n",
                bytes_text(full.peak).c_str(), bytes_text(base.peak).c_str(), bytes_text(kMemory).c_str());
    EXPECT_LE(held, kMemory + kSlack);
    EXPECT_GT(full.chunks, 1u);
}

}  // namespace
}  // namespace lucarne::octree
