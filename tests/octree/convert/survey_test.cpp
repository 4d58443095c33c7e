// The benchmark's cloud, at a size that a test can afford. The bytes a point takes on disk can be tested
// without a clock.
#include <gtest/gtest.h>

#include "io/synthetic/synthetic.h"
#include "octree/cache/cache.h"
#include "octree/convert/build.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

/// Bytes a point of the survey's cache. A million points of the same town are farther apart than the
/// benchmark's twenty million, so each takes about a byte more.
double bytes_a_point(NormalsMode normals) {
    const test::TempFolder folder;
    io::SyntheticOptions scan;
    scan.scene = "survey";
    scan.points = 1'000'000;
    const auto source = io::synthetic_source(scan).value();
    BuildOptions options{.inputs = {source.get()}, .output = folder / "survey.luc", .normals = normals};
    const auto report = build_cache(options).value();
    EXPECT_TRUE(verify_cache(options.output, [](uint64_t) {}));
    return static_cast<double>(std::filesystem::file_size(options.output)) /
           static_cast<double>(report.points);
}

TEST(Survey, PointsWithColourAndIntensityTakeSixAndAHalfBytes) {
    EXPECT_LE(bytes_a_point(NormalsMode::none), 6.5);
}

// 8.4 bytes, and .2 for the lines of points at edges.
TEST(Survey, PointsWithNormalsAndLinesTakeEightPointSixBytes) {
    EXPECT_LE(bytes_a_point(NormalsMode::estimate), 8.6);
}

}  // namespace
}  // namespace lucarne::octree
