// Which normals a cache shows and exports: the file's own, or the estimated ones that were requested instead.
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "io/formats/scan.h"
#include "octree/cache/cache.h"
#include "octree/convert/build.h"
#include "octree/edit/edit.h"
#include "octree/export/export.h"
#include "octree/tree/point_normals.h"
#include "octree/tree/stored_names.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using test::ComputedSource;
using test::TempFolder;

/// A floor, seen from above, whose normals are those of a wall.
ComputedSource floor_with(const glm::vec3& normal, uint64_t seed = 1) {
    io::Schema schema;
    schema.position = io::PositionType::f32;
    schema.stride = 12;
    schema.add(std::string(io::names::normal), io::ScalarType::f32, 3);
    return {schema, 2000, [normal, seed](uint64_t index, std::byte* record) {
                Random random(seed, index);
                io::store(record, glm::vec3(random.uniform(), random.uniform(), 0));
                io::store(record + 12, normal);
            }};
}

const glm::vec3 kJunk(1, 0, 0);

Result<std::unique_ptr<NodeSource>> converted(std::vector<const io::PointSource*> inputs,
                                              const std::filesystem::path& cache, NormalsMode mode) {
    BuildOptions options;
    options.inputs = std::move(inputs);
    options.output = cache;
    options.normals = mode;
    LUCARNE_ASSIGN([[maybe_unused]] const auto report, build_cache(options));
    return open_cache(cache);
}

Result<std::unique_ptr<io::PointSource>> exported(const NodeSource& source,
                                                  const std::filesystem::path& output,
                                                  const ExportOptions& options = {}) {
    const Exporter exporter(source, options);
    LUCARNE_ASSIGN(const auto writer,
                   io::create_scan(output, exporter.schema(), exporter.info(), exporter.write_options(true)));
    LUCARNE_TRY(exporter.write(*writer, [](uint64_t) {}));
    return io::open_scan(output);
}

void write_scan(const io::PointSource& source, const std::filesystem::path& path) {
    const auto writer = io::create_scan(path, source.schema(), source.info(), {});
    ASSERT_TRUE(writer) << writer.error().line();
    const auto records = io::testing::read_all(source);
    ASSERT_TRUE((*writer)->write(records->bytes));
    ASSERT_TRUE((*writer)->finish());
}

/// Counts the points whose normal satisfies `holds`. Formats without vectors have an attribute per component.
template <class Holds>
size_t count(const io::PointSource& scan, const std::string& name, const Holds& holds) {
    const auto& schema = scan.schema();
    const auto* first = schema.find(name) ? schema.find(name) : schema.find(name + "_0");
    const auto records = io::testing::read_all(scan);
    if (!first || !records || first->type != io::ScalarType::f32) return 0;
    size_t found = 0;
    for (size_t i = 0; i < records->count; ++i)
        found += holds(glm::dvec3(io::load<glm::vec3>(&records->bytes[i * schema.stride + first->offset])));
    return found;
}
bool upright(const glm::dvec3& n) {
    return std::abs(n.z) > .99;
}
bool junk(const glm::dvec3& n) {
    return n == glm::dvec3(kJunk);
}

size_t drawn(const NodeSource& source, bool (*holds)(const glm::dvec3&)) {
    const PointNormals normals(source.header().schema);
    size_t found = 0;
    for (uint32_t node = 0; node < source.nodes().size(); ++node) {
        const auto data = source.load(node);
        for (size_t i = 0; data && i < data->count; ++i)
            found += holds(glm::dvec3(normals.of(&data->records[i * source.header().schema.stride])));
    }
    return found;
}

TEST(ReplacedNormals, EstimatedOnesThatWereAskedForAreDrawnAndExported) {
    for (const std::string extension : {".ply", ".las", ".pcd"}) {
        SCOPED_TRACE(extension);
        const TempFolder folder;
        write_scan(floor_with(kJunk), folder / ("junk" + extension));
        const auto scan = io::open_scan(folder / ("junk" + extension));
        ASSERT_TRUE(scan) << scan.error().line();
        const auto cache = converted({scan->get()}, folder / "a.luc", NormalsMode::estimate);
        ASSERT_TRUE(cache) << cache.error().line();
        EXPECT_GT(drawn(**cache, upright), 1980u);
        const auto back = exported(**cache, folder / ("back" + extension));
        ASSERT_TRUE(back) << back.error().line();
        EXPECT_GT(count(**back, "normal", upright), 1980u);
        EXPECT_EQ(count(**back, "normal_in_file", junk), 2000u) << "export loses nothing";
    }
}

TEST(ReplacedNormals, ExportOfAnExportKeepsEveryGeneration) {
    const TempFolder folder;
    const auto scan = floor_with(kJunk);
    const auto first = converted({&scan}, folder / "a.luc", NormalsMode::estimate);
    const auto once = exported(**first, folder / "once.las");
    const auto second = converted({once->get()}, folder / "b.luc", NormalsMode::estimate);
    ASSERT_TRUE(second) << second.error().line();
    const auto twice = exported(**second, folder / "twice.las");
    ASSERT_TRUE(twice) << twice.error().line();
    EXPECT_GT(count(**twice, "normal", upright), 1980u);
    EXPECT_GT(count(**twice, "normal_in_file", upright), 1980u);
    EXPECT_EQ(count(**twice, "normal_in_file_in_file", junk), 2000u);
    const auto kept = converted({once->get()}, folder / "c.luc", NormalsMode::automatic);
    const auto same = exported(**kept, folder / "same.las");
    ASSERT_TRUE(same) << same.error().line();
    EXPECT_TRUE((*same)->schema() == (*once)->schema());
    EXPECT_TRUE(test::sorted_records(**same, (*same)->schema().stride) ==
                test::sorted_records(**once, (*once)->schema().stride));
}

TEST(ReplacedNormals, TheFilesOwnAreKeptUnlessTheyPointNowhere) {
    const TempFolder folder;
    const auto with = floor_with(kJunk, 1), nowhere = floor_with(glm::vec3(0), 2);
    io::Schema bare;
    const ComputedSource without(bare, 2000, [](uint64_t index, std::byte* record) {
        Random random(3, index);
        io::store(record, glm::dvec3(random.uniform(), random.uniform(), 0));
    });
    const auto cache = converted({&with, &nowhere, &without}, folder / "a.luc", NormalsMode::automatic);
    ASSERT_TRUE(cache) << cache.error().line();
    EXPECT_EQ(drawn(**cache, junk), 2000u);
    EXPECT_GT(drawn(**cache, upright), 3960u);
    const auto back = exported(**cache, folder / "a.ply", {.normals = true});
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_EQ(count(**back, "normal", junk), 2000u);
    EXPECT_GT(count(**back, "normal", upright), 3960u);
    const auto plain = exported(**cache, folder / "b.ply");
    EXPECT_EQ(count(**plain, "normal", upright), 0u);
}

TEST(ReplacedNormals, WhatIsAppendedIsEstimatedToo) {
    const TempFolder folder;
    const auto before = floor_with(kJunk, 1), added = floor_with(glm::vec3(0, 1, 0), 2);
    ASSERT_TRUE(converted({&before}, folder / "a.luc", NormalsMode::estimate));
    const auto done = append_to_cache({&added}, {.cache = folder / "a.luc"});
    ASSERT_TRUE(done) << done.error().line();
    const auto cache = open_cache(folder / "a.luc");
    ASSERT_TRUE(cache) << cache.error().line();
    EXPECT_GT(drawn(**cache, upright), 3960u);
    const auto back = exported(**cache, folder / "a.ply");
    EXPECT_EQ(count(**back, "normal_in_file", junk), 2000u);
    EXPECT_EQ(count(**back, "normal_in_file", [](const auto& n) { return n == glm::dvec3(0, 1, 0); }), 2000u);
}

TEST(StoredNames, GiveEveryNameBack) {
    for (const std::string name : {"normal", "area", "scan", "normal_oct", "color", "heat_in_file",
                                   "area_in_file", "normal_in_file", "normal_in_file_in_file"})
        for (const bool replace : {false, true}) {
            const io::Attribute attribute{name, io::ScalarType::f32, 3, 0};
            EXPECT_EQ(name_in_file(stored_name(attribute, replace)), name);
        }
    EXPECT_EQ(stored_name({"normal", io::ScalarType::f32, 3, 0}, false), "normal");
    EXPECT_EQ(stored_name({"normal", io::ScalarType::u8, 1, 0}, false), "normal_in_file");
    EXPECT_EQ(name_in_file("heat_in_file"), "heat_in_file");
}

}  // namespace
}  // namespace lucarne::octree
