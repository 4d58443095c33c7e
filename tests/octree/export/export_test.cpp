// From a scan file to a cache and back: the same points with the same attributes.
#include "octree/export/export.h"

#include <gtest/gtest.h>

#include "io/core/random.h"
#include "io/formats/scan.h"
#include "octree/cache/cache.h"
#include "octree/convert/build.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using test::TempFolder;

/// Reads a mesh as its vertices: samples of its surface are not in the file.
const io::ReadOptions kVertices{"", true, {0, 0, true}};

Result<void> convert(std::vector<const io::PointSource*> inputs, const std::filesystem::path& cache) {
    BuildOptions options{.inputs = std::move(inputs), .output = cache, .normals = NormalsMode::none};
    LUCARNE_ASSIGN([[maybe_unused]] const auto report, build_cache(options));
    return {};
}

Result<uint64_t> export_to(const std::filesystem::path& cache, const std::filesystem::path& output) {
    LUCARNE_ASSIGN(const auto source, open_cache(cache));
    const Exporter exporter(*source, {});
    LUCARNE_ASSIGN(const auto writer, io::create_scan(output, exporter.schema(), exporter.info(), {}));
    return exporter.write(*writer, [](uint64_t) {});
}

/// Converts a scan and exports it. `extension` is that of the written file.
void expect_same_after_round_trip(const std::filesystem::path& scan, const std::string& extension) {
    SCOPED_TRACE(scan.string());
    const TempFolder folder;
    const auto before = io::open_scan(scan, kVertices);
    ASSERT_TRUE(before) << before.error().line();
    const auto converted = convert({before->get()}, folder / "a.luc");
    ASSERT_TRUE(converted) << converted.error().line();
    const auto output = folder / ("b" + extension);
    const auto exported = export_to(folder / "a.luc", output);
    ASSERT_TRUE(exported) << exported.error().line();
    const auto after = io::open_scan(output);
    ASSERT_TRUE(after) << after.error().line();
    ASSERT_EQ((*after)->schema(), (*before)->schema());
    EXPECT_TRUE(extension == ".ply" || (*after)->info().format == (*before)->info().format);
    const uint32_t stride = (*before)->schema().stride;
    EXPECT_TRUE(test::sorted_records(**after, stride) == test::sorted_records(**before, stride));
}

void write_scan(const std::filesystem::path& path, const test::ComputedSource& source) {
    const auto writer = io::create_scan(path, source.schema(), source.info(), {});
    ASSERT_TRUE(writer) << writer.error().line();
    const auto reader = source.open();
    io::PointBatch batch;
    while ((*reader)->read(batch, 5000).value_or(0) > 0) ASSERT_TRUE((*writer)->write(batch.bytes));
    const auto finished = (*writer)->finish();
    ASSERT_TRUE(finished) << finished.error().line();
}

test::ComputedSource cloud(io::PositionType position, uint64_t seed) {
    io::Schema schema;
    schema.position = position;
    if (position == io::PositionType::i32_scaled)
        schema.scale = glm::dvec3(0.001), schema.offset = glm::dvec3(500, 600, 7);
    schema.stride = static_cast<uint32_t>(io::position_bytes(position));
    schema.add("intensity", io::ScalarType::u16);
    schema.add("classification", io::ScalarType::u8);
    schema.add("color", io::ScalarType::u16, 3);
    if (position != io::PositionType::i32_scaled) {
        schema.add("normal", io::ScalarType::f32, 3);
        schema.add("temperature", io::ScalarType::f64);
        schema.add("area", io::ScalarType::f32);  // the name of one of the cache's own attributes
    }
    return {schema, 40'000, [schema, seed](uint64_t index, std::byte* record) {
                Random random(seed, index);
                for (size_t axis = 0; axis < 3; ++axis) {
                    const double v = 10 * random.uniform();
                    if (schema.position == io::PositionType::i32_scaled)
                        io::store(record + 4 * axis, static_cast<int32_t>(1000 * v));
                    else if (schema.position == io::PositionType::f32)
                        io::store(record + 4 * axis, static_cast<float>(v));
                    else
                        io::store(record + 8 * axis, v);
                }
                for (const auto& a : schema.attributes)
                    for (size_t c = 0; c < a.components; ++c)
                        io::store_scalar(a.type, record + a.offset + c * io::scalar_bytes(a.type),
                                         a.name == "classification" ? 2.0 : 1000 * random.uniform());
            }};
}

TEST(Export, GivesLasBackAsItWas) {
    const TempFolder folder;
    write_scan(folder / "a.las", cloud(io::PositionType::i32_scaled, 1));
    expect_same_after_round_trip(folder / "a.las", ".las");
}

TEST(Export, GivesFloatAndDoublePlyBackAsTheyWere) {
    for (const auto position : {io::PositionType::f32, io::PositionType::f64}) {
        const TempFolder folder;
        write_scan(folder / "a.ply", cloud(position, 2));
        expect_same_after_round_trip(folder / "a.ply", ".ply");
    }
}

TEST(Export, KeepsTheScanOfEachPointOfSeveral) {
    const TempFolder folder;
    const auto a = cloud(io::PositionType::f64, 3), b = cloud(io::PositionType::f64, 4);
    ASSERT_TRUE(convert({&a, &b}, folder / "two.luc"));
    ASSERT_TRUE(export_to(folder / "two.luc", folder / "two.ply"));
    const auto after = io::open_scan(folder / "two.ply");
    ASSERT_TRUE(after) << after.error().line();
    const auto* scan = (*after)->schema().find("scan");
    ASSERT_TRUE(scan);
    const auto records = io::testing::read_all(**after);
    ASSERT_TRUE(records);
    size_t second = 0;
    for (size_t i = 0; i < records->count; ++i)
        second += io::load<uint16_t>(&records->bytes[i * (*after)->schema().stride + scan->offset]) == 1;
    EXPECT_EQ(records->count, 80'000u);
    EXPECT_EQ(second, 40'000u);
}

/// Points of one colour, all components equal.
test::ComputedSource of_colour(io::ScalarType type, double value, uint32_t bits) {
    io::Schema schema;
    schema.add(std::string(io::names::color), type, 3);
    test::ComputedSource source(schema, 100, [schema, value](uint64_t index, std::byte* record) {
        for (size_t axis = 0; axis < 3; ++axis)
            io::store(record + 8 * axis, static_cast<double>(index * (axis + 1) % 10));
        const auto& color = schema.attributes[0];
        for (size_t c = 0; c < 3; ++c)
            io::store_scalar(color.type, record + color.offset + c * io::scalar_bytes(color.type), value);
    });
    source.info().color_bits = bits;
    return source;
}

TEST(Export, SpreadsColoursOf8BitsAmongOthersOf16) {
    const auto bytes = of_colour(io::ScalarType::u8, 200, 8), narrow = of_colour(io::ScalarType::u16, 200, 8),
               wide = of_colour(io::ScalarType::u16, 51400, 16);
    for (const auto& inputs : {std::vector<const io::PointSource*>{&bytes, &narrow, &wide},
                               {&wide, &narrow},
                               {&narrow, &wide, &bytes},
                               {&bytes, &narrow}}) {
        const TempFolder folder;
        ASSERT_TRUE(convert(inputs, folder / "a.luc"));
        ASSERT_TRUE(export_to(folder / "a.luc", folder / "b.las"));
        const auto after = io::open_scan(folder / "b.las");
        ASSERT_TRUE(after) << after.error().line();
        EXPECT_EQ((*after)->info().color_bits, 16u);
        const auto& schema = (*after)->schema();
        const auto records = io::testing::read_all(**after);
        for (size_t at = 0; at < records->bytes.size(); at += schema.stride)
            ASSERT_EQ(io::load<uint16_t>(&records->bytes[at + schema.find(io::names::color)->offset]), 51400);
    }
}

/// A damaged cache may have points whose scan number names no scan.
class WithoutScans final : public NodeSource {
 public:
    WithoutScans() {
        header_.schema.stride = static_cast<uint32_t>(io::position_bytes(header_.schema.position));
        header_.schema.add(std::string(io::names::color), io::ScalarType::u16, 3);
        header_.schema.add(std::string(io::names::scan), io::ScalarType::u16);
    }
    const SourceHeader& header() const override { return header_; }
    NodeTable nodes() const override { return {}; }
    Result<NodeData> load(uint32_t) const override { return rejected("nothing", "has no node"); }

 private:
    SourceHeader header_;
};

TEST(Export, KnowsNoWhiteOfScansThatAreNotThere) {
    const WithoutScans source;
    EXPECT_EQ(Exporter(source, {}).info().color_bits, io::ScanInfo{}.color_bits);
}

TEST(Export, LeavesColoursOf8BitsIn16AsTheyAreInLas) {
    const auto computed = of_colour(io::ScalarType::u16, 200, 16);  // written as they are
    const TempFolder folder;
    ASSERT_TRUE(convert({&computed}, folder / "a.luc"));
    ASSERT_TRUE(export_to(folder / "a.luc", folder / "a.las"));
    const auto las = io::open_scan(folder / "a.las");
    ASSERT_TRUE(las) << las.error().line();
    ASSERT_EQ((*las)->info().color_bits, 8u);
    ASSERT_TRUE(convert({las->get(), las->get()}, folder / "b.luc"));
    ASSERT_TRUE(export_to(folder / "b.luc", folder / "b.las"));
    EXPECT_EQ((*io::open_scan(folder / "b.las"))->info().color_bits, 8u);
}

TEST(Export, GivesEverySharedLasAndPlyBackAsItWas) {
    const auto data = io::testing::shared_data();
    if (data.empty()) GTEST_SKIP() << "no shared scans here";
    size_t files = 0;
    for (const std::string kind : {"las", "ply"})
        for (const auto& entry : std::filesystem::directory_iterator(data / kind)) {
            if (entry.path().extension() != "." + kind) continue;
            const auto source = io::open_scan(entry.path(), kVertices);
            if (!source || io::testing::read_all(**source)->count == 0) continue;  // nothing to convert
            expect_same_after_round_trip(entry.path(), "." + kind);
            ++files;
        }
    EXPECT_GT(files, 8u);
}

}  // namespace
}  // namespace lucarne::octree
