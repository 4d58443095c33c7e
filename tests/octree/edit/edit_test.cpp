// Appending to, deleting from and compacting a cache give the points and the tree of a new build.
#include "octree/edit/edit.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "io/files/update_file.h"
#include "octree/cache/cache.h"
#include "octree/cache/file.h"
#include "octree/convert/build.h"
#include "octree/edit/edit_plan.h"
#include "octree/tree/attributes.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using test::ComputedSource;
using test::TempFolder;

io::Schema las_like() {
    io::Schema schema;
    schema.position = io::PositionType::i32_scaled;
    schema.scale = glm::dvec3(0.001);
    schema.offset = glm::dvec3(400, 5000, 100);
    schema.stride = 12;
    schema.add("color", io::ScalarType::u16, 3);
    schema.add("intensity", io::ScalarType::u16);
    return schema;
}

/// A floor with a bumpy roof over [from, from + size]; all records are different.
ComputedSource patch(uint64_t points, glm::dvec2 from, double size, uint64_t seed) {
    ComputedSource source{
        las_like(), points, [=](uint64_t index, std::byte* record) {
            Random random(seed, index);
            glm::dvec3 p(from.x + size * random.uniform(), from.y + size * random.uniform(), 0.0);
            if (index % 3 == 0) p.z = 4 + std::sin(p.x) * std::cos(p.y);
            for (int axis = 0; axis < 3; ++axis)
                io::store(record + 4 * axis, static_cast<int32_t>(std::lround(p[axis] * 1000)));
            io::store(record + 12, random.next());
        }};
    source.info().path = "patch " + std::to_string(seed);
    return source;
}

Result<BuildReport> build(std::vector<const io::PointSource*> inputs, const std::filesystem::path& output,
                          NormalsMode normals = NormalsMode::none) {
    BuildOptions options;
    options.inputs = std::move(inputs);
    options.output = output;
    options.normals = normals;
    options.memory = uint64_t{256} << 20;
    options.threads = 2;
    return build_cache(options);
}

EditOptions edit(const std::filesystem::path& cache, uint64_t memory = uint64_t{256} << 20) {
    return {.cache = cache, .memory = memory, .threads = 2};
}

std::unique_ptr<CacheFile> opened(const std::filesystem::path& path) {
    auto cache = CacheFile::open(path);
    EXPECT_TRUE(cache) << cache.error().line();
    return cache ? std::move(*cache) : nullptr;
}

/// Checks that the cache is sound and has the records of `fresh`, except for the estimates. In the schema the
/// positions come first and the estimates last.
void expect_points_of(const std::filesystem::path& path, const std::filesystem::path& fresh) {
    const auto verified = verify_cache(path, [](uint64_t) {});
    ASSERT_TRUE(verified) << verified.error().line();
    const auto cache = opened(path), expected = opened(fresh);
    ASSERT_TRUE(cache && expected);
    EXPECT_EQ(cache->header().schema, expected->header().schema);
    EXPECT_EQ(cache->header().points, expected->header().points);
    EXPECT_EQ(cache->header().min, expected->header().min);
    EXPECT_EQ(cache->header().max, expected->header().max);
    size_t bytes = expected->header().schema.stride;
    for (const auto name : {io::names::normal_oct, io::names::area})
        if (const auto* estimated = expected->header().schema.find(name))
            bytes = std::min<size_t>(bytes, estimated->offset);
    EXPECT_TRUE(test::sorted_records(*cache, bytes) == test::sorted_records(*expected, bytes));
}

/// Checks that the same root cube gives the same tree, node by node, with the same floors.
void expect_tree_of(const std::filesystem::path& path, const std::filesystem::path& fresh, double floors) {
    const auto cache = opened(path), expected = opened(fresh);
    ASSERT_EQ(cache->nodes().size(), expected->nodes().size());
    for (uint32_t i = 0; i < cache->nodes().size(); ++i) {
        const auto &node = cache->nodes()[i], &other = expected->nodes()[i];
        ASSERT_EQ(node.key, other.key);
        EXPECT_EQ(node.child_mask, other.child_mask) << i;
        EXPECT_EQ(node.count, other.count) << i;
        for (size_t step = 0; step < kPrefixSteps; ++step)
            EXPECT_NEAR(node.area_floor[step], other.area_floor[step], floors * other.area_floor[step]) << i;
    }
}

TEST(Append, OfAScanInsideGivesTheTreeOfAFreshBuildAndLeavesMostNodesWhereTheyAre) {
    const TempFolder folder;
    const auto whole = patch(300'000, {0, 0}, 40, 1), added = patch(4'000, {11, 12}, 2, 2);
    ASSERT_TRUE(build({&whole}, folder / "a.luc"));
    ASSERT_TRUE(build({&whole, &added}, folder / "fresh.luc"));
    const auto before = io::testing::read_bytes(folder / "a.luc");
    const auto report = append_to_cache({&added}, edit(folder / "a.luc"));
    ASSERT_TRUE(report) << report.error().line();
    EXPECT_EQ(report->added, 4'000u);
    EXPECT_GT(report->kept_nodes, report->nodes / 3);
    expect_points_of(folder / "a.luc", folder / "fresh.luc");
    expect_tree_of(folder / "a.luc", folder / "fresh.luc", 1e-4);
    // The old bytes stay unchanged, except for one superblock.
    const auto after = io::testing::read_bytes(folder / "a.luc");
    EXPECT_EQ(after.substr(0, 4096), before.substr(0, 4096));
    EXPECT_EQ(after.substr(8192, before.size() - 8192), before.substr(8192));
}

TEST(Append, OutsideGrowsTheRootAndLosesNoPoint) {
    const TempFolder folder;
    const auto first = patch(100'000, {0, 0}, 20, 1);
    const auto around = patch(20'000, {-90, 30}, 15, 2), far = patch(3'000, {700, -300}, 5, 3);
    ASSERT_TRUE(build({&first}, folder / "a.luc"));
    ASSERT_TRUE(build({&first, &around, &far}, folder / "fresh.luc"));
    for (const auto* scan : {&around, &far}) {
        const auto report = append_to_cache({scan}, edit(folder / "a.luc"));
        ASSERT_TRUE(report) << report.error().line();
        EXPECT_GT(report->kept_nodes, 0u);
    }
    expect_points_of(folder / "a.luc", folder / "fresh.luc");
    const Cube root = opened(folder / "a.luc")->header().root;
    EXPECT_GE(root.doublings, 5u);
    EXPECT_EQ(opened(folder / "a.luc")->superblock().generation, 3u);
}

TEST(Append, OfManyScansOneByOneIsAllOfThem) {
    const TempFolder folder;
    std::vector<ComputedSource> scans;
    for (uint64_t i = 0; i < 6; ++i)
        scans.push_back(patch(15'000, {7.0 * static_cast<double>(i), 3}, 12, 10 + i));
    ASSERT_TRUE(build({&scans[0]}, folder / "a.luc"));
    std::vector<const io::PointSource*> all;
    for (const auto& scan : scans) {
        all.push_back(&scan);
        if (all.size() == 1) continue;
        const auto report = append_to_cache({&scan}, edit(folder / "a.luc", uint64_t{16} << 20));
        ASSERT_TRUE(report) << report.error().line();
    }
    ASSERT_TRUE(build(all, folder / "fresh.luc"));
    expect_points_of(folder / "a.luc", folder / "fresh.luc");
    EXPECT_EQ(opened(folder / "a.luc")->header().scans.size(), 6u);
}

TEST(Append, UnifiesOtherAttributesAndLatticesAsAFreshBuildDoes) {
    const TempFolder folder;
    const auto first = patch(120'000, {0, 0}, 30, 1);
    io::Schema other;
    other.position = io::PositionType::f32;
    other.stride = 12;
    other.add("gps_time", io::ScalarType::f64);
    other.add("intensity", io::ScalarType::u8);
    other.add("area", io::ScalarType::f32);  // the name of one of the cache's own attributes
    const ComputedSource second{other, 2'000, [](uint64_t index, std::byte* record) {
                                    Random random(9, index);
                                    io::store(record, static_cast<float>(400 + 3 * random.uniform()));
                                    io::store(record + 4, static_cast<float>(5000 + 3 * random.uniform()));
                                    io::store(record + 8, 100.5f);
                                    io::store(record + 12, random.uniform());
                                    io::store(record + 20, static_cast<uint8_t>(index));
                                    io::store(record + 21, 1.5f);
                                }};
    ASSERT_TRUE(build({&first}, folder / "a.luc"));
    ASSERT_TRUE(build({&first, &second}, folder / "fresh.luc"));
    const auto report = append_to_cache({&second}, edit(folder / "a.luc"));
    ASSERT_TRUE(report) << report.error().line();
    EXPECT_GT(report->kept_nodes, 0u);
    EXPECT_EQ(opened(folder / "a.luc")->header().layouts.size(), 1u);
    expect_points_of(folder / "a.luc", folder / "fresh.luc");
    ASSERT_TRUE(compact_cache(folder / "a.luc", {}));
    expect_points_of(folder / "a.luc", folder / "fresh.luc");
}

TEST(Append, RefusesAnotherUnitAPlaceTooFarAndASecondWriter) {
    const TempFolder folder;
    const auto first = patch(1'000, {0, 0}, 30, 1);
    auto feet = patch(1'000, {0, 0}, 30, 2);
    feet.info().metres_per_unit = 0.3048;
    feet.info().unit_stated = true;
    const ComputedSource far{io::Schema{}, 1,
                             [](uint64_t, std::byte* record) { io::store(record, glm::dvec3(1e12, 0, 0)); }};
    ASSERT_TRUE(build({&first}, folder / "a.luc"));
    const auto before = io::testing::read_bytes(folder / "a.luc");
    for (const io::PointSource* scan :
         {static_cast<const io::PointSource*>(&feet), static_cast<const io::PointSource*>(&far)}) {
        const auto report = append_to_cache({scan}, edit(folder / "a.luc"));
        ASSERT_FALSE(report);
        EXPECT_EQ(report.error().kind, ErrorKind::input_rejected);
    }
    const auto held = UpdateFile::open(folder / "a.luc", "");
    ASSERT_TRUE(held);
    const auto second = append_to_cache({&first}, edit(folder / "a.luc"));
    ASSERT_FALSE(second);
    EXPECT_NE(second.error().line().find("another process"), std::string::npos);
    EXPECT_EQ(io::testing::read_bytes(folder / "a.luc"), before);
}

TEST(Append, LeavesReadersWithTheStateTheyOpened) {
    const TempFolder folder;
    const auto first = patch(60'000, {0, 0}, 30, 1), second = patch(30'000, {5, 5}, 30, 2);
    ASSERT_TRUE(build({&first}, folder / "a.luc"));
    const auto reader = opened(folder / "a.luc");
    const auto before = test::sorted_records(*reader, 20);
    ASSERT_TRUE(append_to_cache({&second}, edit(folder / "a.luc")));
    EXPECT_TRUE(test::sorted_records(*reader, 20) == before);
    ASSERT_TRUE(compact_cache(folder / "a.luc", {}));
    EXPECT_TRUE(test::sorted_records(*reader, 20) == before);
}

/// The points of a cache with normals that are on the floor (z at most 102): their mean |normal.z|, the share
/// of normals that point up, the sum of areas.
struct Surface {
    double upright = 0, up = 0, area = 0;
    uint64_t points = 0;
};
Surface surface_of_floor(const std::filesystem::path& path) {
    const auto cache = opened(path);
    const auto& header = cache->header();
    const auto *normal = header.schema.find(io::names::normal_oct),
               *area = header.schema.find(io::names::area);
    Surface result;
    for (uint32_t node = 0; node < cache->nodes().size(); ++node) {
        const auto data = cache->load(node);
        for (size_t i = 0; data && i < data->count; ++i) {
            const std::byte* record = &data->records[i * header.schema.stride];
            if (io::position_of(header.schema, record).z > 102) continue;
            const auto n =
                decode_normal(io::load<NormalCode>(record + normal->offset)).value_or(glm::vec3(0));
            result.upright += std::abs(n.z);
            result.up += n.z > 0;
            result.area += decode_area(io::load<uint16_t>(record + area->offset), header.root.first_size());
            ++result.points;
        }
    }
    const auto count = static_cast<double>(result.points);
    result.upright /= count;
    result.up /= count;
    return result;
}

TEST(Append, GivesNewPointsNormalsAndSharesTheSurfaceAnew) {
    const TempFolder folder;
    const auto first = patch(90'000, {0, 0}, 30, 1), over = patch(90'000, {0, 0}, 30, 2);
    ASSERT_TRUE(build({&first}, folder / "a.luc", NormalsMode::estimate));
    const Surface before = surface_of_floor(folder / "a.luc");
    const auto report = append_to_cache({&over}, edit(folder / "a.luc"));
    ASSERT_TRUE(report) << report.error().line();
    const Surface after = surface_of_floor(folder / "a.luc");
    EXPECT_EQ(after.points, 2 * before.points);
    EXPECT_GT(after.upright, 0.99);
    EXPECT_NEAR(after.up, before.up, 0.01);  // the new normals point to the side of the old ones
    // Twice the points on the same floor must not increase its area.
    EXPECT_NEAR(before.area / 900, 1, 0.05);
    EXPECT_NEAR(after.area / 900, 1, 0.05);
}

TEST(Append, BesideTheOldKeepsTheSumOfAreas) {
    const TempFolder folder;
    const auto first = patch(90'000, {0, 0}, 30, 1), beside = patch(90'000, {30, 0}, 30, 2);
    ASSERT_TRUE(build({&first}, folder / "a.luc", NormalsMode::estimate));
    const auto report = append_to_cache({&beside}, edit(folder / "a.luc"));
    ASSERT_TRUE(report) << report.error().line();
    const Surface after = surface_of_floor(folder / "a.luc");
    EXPECT_GT(after.upright, 0.99);
    EXPECT_NEAR(after.area / 1800, 1, 0.05);
}

/// A rectangle of so many points.
struct Sheet {
    uint64_t points;
    glm::dvec3 corner, u, v;
};
ComputedSource sheets(std::vector<Sheet> parts, uint64_t seed) {
    io::Schema schema;
    schema.position = io::PositionType::f32;
    schema.stride = 12;
    uint64_t all = 0;
    for (const Sheet& part : parts) all += part.points;
    return {schema, all, [=](uint64_t index, std::byte* record) {
                Random random(seed, index);
                uint64_t left = index;
                size_t part = 0;
                while (left >= parts[part].points) left -= parts[part++].points;
                const double u = random.uniform(), v = random.uniform();
                io::store(record, glm::vec3(parts[part].corner + u * parts[part].u + v * parts[part].v));
            }};
}

/// Returns the share of the points of a cache before x = 61 whose normals point out of the box of [0, 60] x
/// [0, 30] x [0, 20].
double share_outward(const std::filesystem::path& path) {
    const auto cache = opened(path);
    const io::Schema& schema = cache->header().schema;
    const auto* normal = schema.find(io::names::normal_oct);
    double all = 0, outward = 0;
    for (uint32_t node = 0; node < cache->nodes().size(); ++node) {
        const auto data = cache->load(node);
        for (size_t i = 0; data && i < data->count; ++i) {
            const std::byte* record = &data->records[i * schema.stride];
            const glm::dvec3 at = io::position_of(schema, record);
            if (at.x > 61) continue;
            const auto n = decode_normal(io::load<NormalCode>(record + normal->offset));
            ++all;
            // From the middle, in halves of the box's sizes: one of them is 1 on its sides.
            const glm::dvec3 from = (at - glm::dvec3(30, 15, 10)) / glm::dvec3(30, 15, 10);
            const glm::dvec3 size = glm::abs(from);
            const int axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
            outward += n && (*n)[axis] * from[axis] > 0;
        }
    }
    return outward / all;
}

// A level sheet faces upward. With floor and walls it is the ceiling of a room and faces downward, but its
// old points keep their side, and the room follows them, whatever the old points of another surface say.
TEST(Append, TurnsASurfaceAsAWholeToTheSideOfItsOldPoints) {
    const TempFolder folder;
    constexpr glm::dvec3 kO(0.0), kX(60, 0, 0), kY(0, 30, 0), kZ(0, 0, 20), kHalf(30, 0, 0);
    constexpr glm::dvec3 kFar(200, 0, 0), kFarX(90, 0, 0);
    const auto first = sheets({{20'000, kZ, kHalf, kY}, {60'000, kFar, kFarX, kY}}, 1);
    const auto second = sheets({{20'000, kZ + kHalf, kHalf, kY},
                                {40'000, kO, kX, kY},
                                {26'000, kO, kX, kZ},
                                {26'000, kY, kX, kZ},
                                {13'000, kO, kY, kZ},
                                {13'000, kX, kY, kZ},
                                {20'000, kFar, kFarX, kY}},
                               2);
    ASSERT_TRUE(build({&first}, folder / "a.luc", NormalsMode::estimate));
    ASSERT_GT(share_outward(folder / "a.luc"), 0.99);
    const auto report = append_to_cache({&second}, edit(folder / "a.luc"));
    ASSERT_TRUE(report) << report.error().line();
    EXPECT_GT(share_outward(folder / "a.luc"), 0.97);
}

TEST(Delete, OfABoxLeavesTheOtherPointsInTheTreeOfAFreshBuild) {
    const TempFolder folder;
    const auto whole = patch(200'000, {0, 0}, 40, 1);
    ASSERT_TRUE(build({&whole}, folder / "a.luc"));
    const Box box{{405, 5005, 0}, {411, 5011, 200}};
    const auto report = delete_from_cache({.box = box}, edit(folder / "a.luc"));
    ASSERT_TRUE(report) << report.error().line();
    EXPECT_GT(report->kept_nodes, 0u);
    std::vector<uint64_t> staying;
    const auto schema = las_like();
    auto reader = whole.open();
    io::PointBatch batch;
    std::vector<std::byte> rest;
    while ((*reader)->read(batch, 1000).value_or(0) > 0)
        for (size_t i = 0; i < batch.count; ++i) {
            const std::byte* record = &batch.bytes[i * schema.stride];
            const auto p = io::position_of(schema, record);
            if (p.x >= 405 && p.x <= 411 && p.y >= 5005 && p.y <= 5011) continue;
            rest.insert(rest.end(), record, record + schema.stride);
        }
    EXPECT_EQ(report->removed, 200'000 - rest.size() / schema.stride);
    EXPECT_GT(report->removed, 1'000u);
    const ComputedSource others{schema, rest.size() / schema.stride, [&](uint64_t index, std::byte* record) {
                                    std::memcpy(record, &rest[index * schema.stride], schema.stride);
                                }};
    ASSERT_TRUE(build({&others}, folder / "fresh.luc"));
    expect_points_of(folder / "a.luc", folder / "fresh.luc");
    if (opened(folder / "fresh.luc")->header().root.min == opened(folder / "a.luc")->header().root.min)
        expect_tree_of(folder / "a.luc", folder / "fresh.luc", 1e-3);
}

TEST(Delete, OfAScanUndoesItsAppendingAndCompactGivesTheSpaceBack) {
    const TempFolder folder;
    const auto first = patch(100'000, {0, 0}, 30, 1), second = patch(50'000, {10, 10}, 60, 2);
    ASSERT_TRUE(build({&first, &second}, folder / "a.luc"));
    ASSERT_TRUE(delete_from_cache({.scan = uint16_t{1}}, edit(folder / "a.luc")));
    const auto cache = opened(folder / "a.luc");
    EXPECT_EQ(cache->header().points, 100'000u);
    EXPECT_TRUE(test::sorted_records(*cache, 20) == test::sorted_records(first, 20));
    const auto compacted = compact_cache(folder / "a.luc", {});
    ASSERT_TRUE(compacted) << compacted.error().line();
    EXPECT_LT(compacted->bytes, compacted->bytes_before * 3 / 4);
    EXPECT_EQ(compacted->bytes, std::filesystem::file_size(folder / "a.luc"));
    const auto verified = verify_cache(folder / "a.luc", [](uint64_t) {});
    ASSERT_TRUE(verified) << verified.error().line();
    EXPECT_TRUE(test::sorted_records(*opened(folder / "a.luc"), 20) == test::sorted_records(first, 20));
}

TEST(Delete, RefusesToLeaveNothingAndToGuess) {
    const TempFolder folder;
    const auto first = patch(2'000, {0, 0}, 30, 1);
    ASSERT_TRUE(build({&first}, folder / "a.luc"));
    const auto before = io::testing::read_bytes(folder / "a.luc");
    EXPECT_FALSE(delete_from_cache({.scan = uint16_t{0}}, edit(folder / "a.luc")));
    EXPECT_FALSE(delete_from_cache({.scan = uint16_t{1}}, edit(folder / "a.luc")));
    const auto nothing = delete_from_cache({.box = Box{{0, 0, 0}, {1, 1, 1}}}, edit(folder / "a.luc"));
    ASSERT_TRUE(nothing);
    EXPECT_EQ(nothing->removed, 0u);
    EXPECT_EQ(io::testing::read_bytes(folder / "a.luc"), before);
}

TEST(GrownRoot, KeepsEveryPlaceInItsOldNode) {
    Random random(5);
    const Cube first{{4.1e5 + 0.1, 5.2e6 + 0.3, 99.7}, 123.456 * (1 + 1e-9)};
    for (int round = 0; round < 50; ++round) {
        const auto far = [&] { return (random.uniform() - 0.5) * std::exp2(20 * random.uniform()); };
        const glm::dvec3 target = first.min + glm::dvec3(far(), far(), far());
        const auto grown = grown_root(first, target, target);
        ASSERT_TRUE(grown);
        EXPECT_EQ(grown->size, first.size * static_cast<double>(1u << grown->doublings));
        const Shift shift(first, *grown);
        for (int i = 0; i < 2000; ++i) {
            glm::dvec3 p = first.min + first.size / (1 + 1e-9) *
                                           glm::dvec3(random.uniform(), random.uniform(), random.uniform());
            // On a border, except for rounding.
            if (i % 2) p = glm::dvec3(first.of(first.place(p).key(9)).min);
            const NodeKey key = first.place(p).key(10);
            ASSERT_EQ(grown->place(p).key(10 + grown->doublings), shift(key));
        }
        const Place at = grown->place(target);
        const Cube cell = grown->of(at.key(12));
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_GE(target[axis], cell.min[axis] - 1e-6 * grown->size);
            EXPECT_LE(target[axis], cell.min[axis] + cell.size + 1e-6 * grown->size);
        }
    }
}

}  // namespace
}  // namespace lucarne::octree
