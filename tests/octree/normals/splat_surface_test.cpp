#include "octree/normals/splat_surface.h"

#include <cmath>
#include <functional>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "octree/cache/cache.h"
#include "octree/convert/build.h"
#include "octree/normals/normals.h"
#include "octree/tree/attributes.h"
#include "octree/tree/footprint.h"
#include "octree/tree/point_normals.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

io::Schema splat_schema() {
    io::Schema schema;
    schema.add(std::string(io::names::splat_axis), io::ScalarType::f32, 3);
    schema.add(std::string(io::names::splat_radius), io::ScalarType::f32);
    return schema;
}

/// Splats of 2 cm on the walls of a box of 4 x 4 x 3 m, or of a ball that hangs in the air. The axes are
/// exact, their signs random; the centres lie up to 2 cm off the surface, so that neighbours alone give poor
/// normals.
test::ComputedSource splats(uint64_t points, bool room) {
    return {splat_schema(), points, [room](uint64_t index, std::byte* record) {
                Random random(11, index);
                const double sign = random.uniform() < 0.5 ? -1 : 1, off = 0.04 * (random.uniform() - 0.5);
                glm::dvec3 p, n;
                if (room) {
                    const auto side = static_cast<int>(index % 6);
                    const glm::dvec3 size(4, 4, 3);
                    n = glm::dvec3(0);
                    n[side / 2] = side % 2 ? 1 : -1;  // outward
                    p = size * glm::dvec3(random.uniform(), random.uniform(), random.uniform());
                    p[side / 2] = side % 2 ? size[side / 2] : 0;
                } else {
                    const double z = 2 * random.uniform() - 1,
                                 angle = 2 * std::numbers::pi * random.uniform();
                    n = {std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z};
                    p = glm::dvec3(0, 0, 5) + n;
                }
                io::store(record, p + off * n);
                io::store(record + 24, glm::vec3(sign * n));
                io::store(record + 36, 0.02f);
            }};
}

/// Returns the share of points whose normal is the axis, turned to the side that `side` gives for a position.
double right_share(const test::ComputedSource& source,
                   const std::function<glm::dvec3(const glm::dvec3&)>& side) {
    const test::TempFolder folder;
    BuildOptions options;
    options.inputs = {&source};
    options.output = folder / "a.luc";
    options.fill = false;
    const auto report = build_cache(options);
    EXPECT_TRUE(report) << report.error().line();
    const auto cache = open_cache(folder / "a.luc");
    if (!cache) return 0;
    const auto& schema = (*cache)->header().schema;
    const PointNormals normals(schema);
    const auto* axis = schema.find(io::names::splat_axis);
    uint64_t right = 0;
    for (uint32_t node = 0; node < (*cache)->nodes().size(); ++node) {
        const auto data = (*cache)->load(node);
        for (size_t i = 0; i < data->count; ++i) {
            const std::byte* record = &data->records[i * schema.stride];
            const glm::dvec3 normal(normals.of(record)), own(io::load<glm::vec3>(record + axis->offset));
            right += std::abs(glm::dot(normal, own)) > 0.999 &&
                     glm::dot(normal, side(io::position_of(schema, record))) > 0;
        }
    }
    return static_cast<double>(right) / static_cast<double>(source.points());
}

TEST(SplatSurface, NormalsAreTheShortestAxesTurnedAsTheWholeSurfaceIs) {
    EXPECT_GT(right_share(splats(40'000, false), [](const glm::dvec3& p) { return p - glm::dvec3(0, 0, 5); }),
              0.98)
        << "a ball's normals point outward";
    // In a corner the nearest wall of a position may be another one than the splat's.
    EXPECT_GT(
        right_share(splats(40'000, true), [](const glm::dvec3& p) { return glm::dvec3(2, 2, 1.5) - p; }),
        0.97)
        << "a room's point inward";
}

TEST(SplatSurface, SizesBoundSharesAndReplaceUnknownOnes) {
    const io::Schema schema = splat_schema();
    const SplatSurface splats(schema);
    std::vector<std::byte> record(schema.stride);
    io::store(&record[36], 0.1f);
    const double face = 4;  // square metres
    const auto own = static_cast<float>(std::numbers::pi * 0.01 / (kCoverageRaw * face));
    EXPECT_FLOAT_EQ(splats.area(record.data(), 0, face), own);
    EXPECT_EQ(splats.area(record.data(), kStrayArea, face), kStrayArea) << "outliers stay outliers";
    EXPECT_FLOAT_EQ(splats.area(record.data(), own / 3, face), own / 3);
    EXPECT_FLOAT_EQ(splats.area(record.data(), 100 * own, face), 4 * own);
    for (const float none : {0.0f, NAN, INFINITY}) {
        io::store(&record[36], none);
        EXPECT_EQ(splats.area(record.data(), 0.25f, face), 0.25f) << none;
    }
    io::store(&record[24], glm::vec3(0, 0, -1));
    EXPECT_EQ(splats.normal(record.data(), glm::vec3(0)), glm::vec3(0, 0, 1)) << "upward";
    EXPECT_EQ(splats.normal(record.data(), glm::vec3(0.6f, 0, -0.8f)), glm::vec3(0, 0, -1));
    for (const glm::vec3 none : {glm::vec3(0), glm::vec3(NAN), glm::vec3(1e20f)}) {
        io::store(&record[24], none);
        EXPECT_EQ(splats.normal(record.data(), glm::vec3(1, 0, 0)), glm::vec3(1, 0, 0));
    }
    // Points of other scans say nothing.
    const io::Schema plain;
    EXPECT_EQ(SplatSurface(plain).area(record.data(), 0.5f, face), 0.5f);
    EXPECT_EQ(SplatSurface(plain).normal(record.data(), glm::vec3(1, 0, 0)), glm::vec3(1, 0, 0));
}

}  // namespace
}  // namespace lucarne::octree
