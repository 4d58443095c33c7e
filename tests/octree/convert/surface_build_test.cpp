// Normals and areas through the whole conversion.
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "io/formats/scan.h"
#include "octree/cache/cache.h"
#include "octree/convert/build.h"
#include "octree/tree/attributes.h"
#include "octree/tree/point_normals.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using test::ComputedSource;
using test::TempFolder;

constexpr double kRadius = 4;
constexpr double kSphere = 4 * std::numbers::pi * kRadius * kRadius;

/// A sphere sampled at random, its upper half four times as densely. It is seen from a station inside or has
/// no station. `normals`: with its true ones.
ComputedSource sphere(uint64_t points, bool normals = false) {
    io::Schema schema;
    if (normals) schema.add("normal", io::ScalarType::f32, 3);
    return {schema, points, [normals](uint64_t index, std::byte* record) {
                Random random(21, index);
                const double z = index % 5 ? random.uniform() : -random.uniform(), s = std::sqrt(1 - z * z);
                const double angle = 2 * std::numbers::pi * random.uniform();
                const glm::dvec3 n(s * std::cos(angle), s * std::sin(angle), z);
                io::store(record, glm::dvec3(100, 200, 300) + kRadius * n);
                if (normals) io::store(record + 24, glm::vec3(n));
            }};
}

std::unique_ptr<NodeSource> converted(const io::PointSource& source, const std::filesystem::path& output,
                                      NormalsMode mode, unsigned threads = 2,
                                      uint64_t memory = uint64_t{1} << 30) {
    BuildOptions options;
    options.inputs = {&source};
    options.output = output;
    options.normals = mode;
    options.threads = threads;
    options.memory = memory;
    const auto report = build_cache(options);
    EXPECT_TRUE(report) << report.error().line();
    EXPECT_TRUE(verify_cache(output, [](uint64_t) {}));
    auto cache = open_cache(output);
    return cache ? std::move(*cache) : nullptr;
}

struct Surfel {
    glm::dvec3 position;
    double area;
};
std::vector<Surfel> surfels(const NodeSource& source, uint32_t node) {
    const auto& header = source.header();
    const auto* area = header.schema.find(io::names::area);
    const auto data = source.load(node);
    std::vector<Surfel> result;
    for (size_t i = 0; data && i < data->count; ++i) {
        const std::byte* record = &data->records[i * header.schema.stride];
        result.push_back({io::position_of(header.schema, record),
                          decode_area(io::load<uint16_t>(record + area->offset), header.root.size)});
    }
    return result;
}

/// The surface of the cut of all nodes down to `level`: every surfel has its own share, or the floor of the
/// deepest node of the cut around it if that is larger.
double surface_of_cut(const NodeSource& source, uint32_t level) {
    const auto nodes = source.nodes();
    double sum = 0;
    for (uint32_t node = 0; node < nodes.size(); ++node) {
        if (nodes[node].key.level > level) break;
        for (const auto& surfel : surfels(source, node)) {
            uint32_t deepest = node;
            for (uint32_t below = node; below != kNoNode && nodes[below].key.level <= level;) {
                deepest = below;
                below = nodes[below].child(
                    source.header().root.place(surfel.position).key(nodes[below].key.level + 1).octant());
            }
            sum += std::max(surfel.area, static_cast<double>(nodes[deepest].area_floor[0]));
        }
    }
    return sum;
}

TEST(SurfaceBuild, AreasOfTheCutsOfAllLevelsAddUpToTheSurface) {
    const TempFolder folder;
    const auto cache = converted(sphere(200'000), folder / "a.luc", NormalsMode::automatic);
    ASSERT_TRUE(cache);
    const uint32_t deepest = cache->nodes().back().key.level;
    ASSERT_GE(deepest, 2u);
    for (uint32_t level = 0; level <= deepest; ++level) {
        const double surface = surface_of_cut(*cache, level);
        std::printf("levels 0 to %u: %.2f of %.2f m2\n", level, surface, kSphere);
        EXPECT_NEAR(surface, kSphere, 0.03 * kSphere);
    }
}

TEST(SurfaceBuild, TheSurfelsOfAMeshAddUpToItsArea) {
    const TempFolder folder;
    // A cube of 1 m, its faces turned outward.
    std::string cube;
    for (int i = 0; i < 8; ++i) cube += fmt::format("v {} {} {}\n", i & 1, i >> 1 & 1, i >> 2 & 1);
    cube += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    io::testing::write_bytes(folder / "cube.obj", cube);
    const auto mesh = io::open_scan(folder / "cube.obj", {"", true, {0, 100'000, false}});
    ASSERT_TRUE(mesh) << mesh.error().line();
    const auto cache = converted(**mesh, folder / "a.luc", NormalsMode::keep);
    ASSERT_TRUE(cache);
    EXPECT_FALSE(cache->header().schema.find(io::names::normal_oct)) << "its own normals are kept";
    EXPECT_NEAR(surface_of_cut(*cache, cache->nodes().back().key.level), 6, 0.02 * 6);
}

TEST(SurfaceBuild, EstimatesNormalsThatLieOnTheSurface) {
    const TempFolder folder;
    auto source = sphere(100'000);
    source.info().stations = {{1, glm::dvec3(100, 200, 300)}};  // inside: normals point to the centre
    const auto cache = converted(source, folder / "a.luc", NormalsMode::automatic);
    ASSERT_TRUE(cache);
    const auto& schema = cache->header().schema;
    const auto* normal = schema.find(io::names::normal_oct);
    ASSERT_TRUE(normal);
    size_t inward = 0, stable = 0;
    for (uint32_t node = 0; node < cache->nodes().size(); ++node) {
        const auto data = cache->load(node);
        for (size_t i = 0; i < data->count; ++i) {
            const std::byte* record = &data->records[i * schema.stride];
            const auto n = decode_normal(io::load<NormalCode>(record + normal->offset));
            if (!n) continue;
            ++stable;
            const glm::dvec3 out =
                glm::normalize(io::position_of(schema, record) - glm::dvec3(100, 200, 300));
            inward += glm::dot(glm::dvec3(*n), out) < -0.99;
        }
    }
    EXPECT_GT(stable, 99'000u);
    EXPECT_GT(inward, stable * 99 / 100);
}

TEST(SurfaceBuild, KeepsTheInputsNormalsAndEstimatesAreasOnly) {
    const TempFolder folder;
    const auto source = sphere(20'000, true);
    for (const auto mode : {NormalsMode::automatic, NormalsMode::keep}) {
        const auto name = folder / (mode == NormalsMode::keep ? "keep.luc" : "auto.luc");
        const auto cache = converted(source, name, mode);
        ASSERT_TRUE(cache);
        EXPECT_FALSE(cache->header().schema.find(io::names::normal_oct));
        EXPECT_TRUE(cache->header().schema.find(io::names::area));
        EXPECT_TRUE(test::sorted_records(*cache, 36) == test::sorted_records(source, 36));
    }
    const auto both = converted(source, folder / "both.luc", NormalsMode::estimate);
    EXPECT_TRUE(both->header().schema.find(io::names::normal_oct) &&
                both->header().schema.find("normal_in_file"));
    EXPECT_FALSE(both->header().schema.find(io::names::normal)) << "the estimated ones replace them";
}

/// The sphere with normals of its own, except every third point's, which are zero or not a number.
ComputedSource partly_known_sphere(uint64_t points) {
    const auto known = std::make_shared<ComputedSource>(sphere(points, true));
    return {known->schema(), points, [known](uint64_t index, std::byte* record) {
                const uint64_t only = index;
                io::PointBatch batch;
                (void)known->pick(std::span(&only, 1), batch);
                std::memcpy(record, batch.bytes.data(), batch.bytes.size());
                const float none = index % 2 ? std::numeric_limits<float>::quiet_NaN() : 0.0f;
                if (index % 3 == 0) io::store(record + 24, glm::vec3(none));
            }};
}

TEST(SurfaceBuild, EstimatesTheNormalsOfPointsWhoseOwnIsZeroOrNoNumber) {
    const TempFolder folder;
    const auto source = partly_known_sphere(30'000);
    BuildOptions options;
    options.inputs = {&source};
    options.output = folder / "a.luc";
    const auto report = build_cache(options);
    ASSERT_TRUE(report) << report.error().line();
    EXPECT_EQ(report->estimated_normals, 10'000u);
    const auto cache = open_cache(folder / "a.luc");
    ASSERT_TRUE(cache) << cache.error().line();
    const auto& schema = (*cache)->header().schema;
    const PointNormals normals(schema);
    uint64_t lit = 0, right = 0;
    for (uint32_t node = 0; node < (*cache)->nodes().size(); ++node) {
        const auto data = (*cache)->load(node);
        for (size_t i = 0; i < data->count; ++i) {
            const std::byte* record = &data->records[i * schema.stride];
            const glm::dvec3 normal(normals.of(record));
            const glm::dvec3 out =
                glm::normalize(io::position_of(schema, record) - glm::dvec3(100, 200, 300));
            lit += normal != glm::dvec3(0.0);
            right += std::abs(glm::dot(normal, out)) > 0.99;
        }
    }
    EXPECT_GT(lit, 29'900u);
    EXPECT_GT(right, 29'700u);
    EXPECT_TRUE(test::sorted_records(**cache, 36) == test::sorted_records(source, 36))
        << "the file's own stay";
}

TEST(SurfaceBuild, KeepsOnlyNormalsThatAreThere) {
    const TempFolder folder;
    const ComputedSource none(sphere(1, true).schema(), 100, [](uint64_t index, std::byte* record) {
        io::store(record, glm::dvec3(static_cast<double>(index), 0, 0));
    });
    BuildOptions options;
    options.inputs = {&none};
    options.output = folder / "a.luc";
    options.normals = NormalsMode::keep;
    const auto report = build_cache(options);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().kind, ErrorKind::arguments);
    EXPECT_NE(report.error().line().find("has no normals to keep"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.luc"));
}

TEST(SurfaceBuild, IsTheSameFileForAnyThreads) {
    const TempFolder folder;
    const auto source = sphere(150'000);
    ASSERT_TRUE(converted(source, folder / "1.luc", NormalsMode::automatic, 1, uint64_t{64} << 20));
    const std::string reference = io::testing::read_bytes(folder / "1.luc");
    for (const unsigned threads : {2u, 4u}) {
        const auto name = folder / (std::to_string(threads) + ".luc");
        ASSERT_TRUE(converted(source, name, NormalsMode::automatic, threads, uint64_t{64} << 20));
        EXPECT_TRUE(io::testing::read_bytes(name) == reference) << threads << " threads";
    }
}

}  // namespace
}  // namespace lucarne::octree
