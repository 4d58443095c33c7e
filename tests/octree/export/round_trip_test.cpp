// Read, converted, exported, read again: the same points with the same attributes, whatever the format.
#include <algorithm>

#include <fmt/format.h>

#include "io/formats/copc/copc.h"
#include "octree/cache/cache.h"
#include "octree/convert/build.h"
#include "octree/export/export.h"
#include "tests/io/formats/las/las_builder.h"
#include "tests/io/io_testing.h"

namespace lucarne::octree {
namespace {

namespace fs = std::filesystem;
using io::testing::Records;
using io::testing::TemporaryFolder;

/// A component of an attribute, however the format stores its components: names in text headers have no
/// blanks, PLY has no integers of 64 bits.
std::optional<double> value_of(const io::Schema& schema, const std::byte* record, const io::Attribute& wanted,
                               uint32_t component) {
    const auto at = [&](const io::Attribute& a, uint32_t c) {
        return io::scalar_at(a.type, record + a.offset + c * io::scalar_bytes(a.type));
    };
    std::string whole = wanted.name;
    for (const bool blanks : {true, false}) {
        if (!blanks) std::replace(whole.begin(), whole.end(), ' ', '_');
        if (const auto* a = schema.find(whole); a && component < a->components) return at(*a, component);
        if (const auto* a = schema.find(fmt::format("{}_{}", whole, component))) return at(*a, 0);
        const auto *low = schema.find(whole + "_low"), *high = schema.find(whole + "_high");
        if (low && high) return at(*low, 0) + at(*high, 0) * 0x1p32;
    }
    return std::nullopt;
}

/// One row per point: its position, in steps of `like`'s scale or unchanged, and the attributes of `like`,
/// sorted.
using Rows = std::vector<std::vector<double>>;
Rows rows_of(const io::PointSource& scan, const io::Schema& like) {
    Rows rows;
    const auto records = io::testing::read_all(scan);
    EXPECT_TRUE(records) << records.error().line();
    if (!records) return rows;
    const auto& schema = scan.schema();
    for (size_t i = 0; i < records->count; ++i) {
        const std::byte* record = &records->bytes[i * schema.stride];
        glm::dvec3 p = io::position_of(schema, record);
        if (like.position == io::PositionType::i32_scaled) {
            const glm::dvec3 steps = (p - like.offset) / like.scale;
            for (int axis = 0; axis < 3; ++axis) {
                p[axis] = std::nearbyint(steps[axis]);
                EXPECT_NEAR(steps[axis], p[axis], 1e-3);
            }
        }
        rows.push_back({p.x, p.y, p.z});
        for (const auto& a : like.attributes)
            for (uint32_t c = 0; c < a.components; ++c) {
                const auto value = value_of(schema, record, a, c);
                if (!value) {
                    ADD_FAILURE() << "no " << a.name;
                    return {};
                }
                rows.back().push_back(*value);
            }
    }
    std::sort(rows.begin(), rows.end());
    return rows;
}

Result<uint64_t> export_as(const fs::path& cache, const fs::path& to) {
    LUCARNE_ASSIGN(const auto source, open_cache(cache));
    const Exporter exporter(*source, {});
    if (io::copc::is_name(to)) return exporter.write_copc(to, false, [](uint64_t) {});
    LUCARNE_ASSIGN(const auto writer, io::create_scan(to, exporter.schema(), exporter.info(), {}));
    return exporter.write(*writer, [](uint64_t) {});
}

void expect_round_trips(const fs::path& file, const std::vector<std::string>& extensions) {
    const TemporaryFolder folder;
    const auto scan = io::open_scan(file, {"", true, {0, 0, true}});
    ASSERT_TRUE(scan) << scan.error().line();
    BuildOptions options;
    options.inputs = {scan->get()};
    options.output = folder / "a.luc";
    options.normals = NormalsMode::none;
    const auto built = build_cache(options);
    ASSERT_TRUE(built) << built.error().line();
    const Rows before = rows_of(**scan, (*scan)->schema());
    ASSERT_EQ(before.size(), built->points);
    for (const std::string& extension : extensions) {
        const auto written = export_as(options.output, folder / ("b" + extension));
        ASSERT_TRUE(written) << extension << ": " << written.error().line();
        const auto copy = io::open_scan(folder / ("b" + extension), {"", true, {0, 0, true}});
        ASSERT_TRUE(copy) << extension << ": " << copy.error().line();
        EXPECT_TRUE(rows_of(**copy, (*scan)->schema()) == before) << file << ' ' << extension;
        EXPECT_EQ((*copy)->info().metres_per_unit, (*scan)->info().metres_per_unit) << extension;
        EXPECT_EQ((*copy)->info().color_bits, (*scan)->info().color_bits) << extension;
        EXPECT_EQ((*copy)->info().stations.size(), (*scan)->info().stations.size()) << extension;
    }
}

const std::vector<std::string> kAll = {".las", ".laz", ".copc.laz", ".ply", ".pcd", ".csv", ".txt"},
                               kFloating = {".ply", ".pcd", ".csv", ".txt"};

struct Coordinates {
    const char* name;
    double scale, x, y, z;
    uint16_t unit;  ///< EPSG code of its unit of length
};
const Coordinates kPlaces[] = {{"UTM", 0.001, 500'000, 4'649'776, 0, 9001},
                               {"LV95", 0.0001, 2'600'000, 1'200'000, 400, 9001},
                               {"Oregon, US survey feet", 0.01, 636'000, 848'000, 0, 9003},
                               {"feet from nowhere", 0.00025, 0, 0, 0, 9002}};

/// Points at both ends of the range of 32 bits and near its middle, with every field in use.
io::testing::LasFile scan_of(const Coordinates& place, uint8_t format) {
    io::testing::LasFile las;
    las.minor = 4;
    las.format = format;
    const double offset[] = {place.x, place.y, place.z};
    for (size_t axis = 0; axis < 3; ++axis) {
        las.scale[axis] = place.scale;
        las.offset[axis] = offset[axis];
    }
    std::string keys;
    for (const uint16_t number : {1, 1, 0, 2, 1024, 0, 1, 1, 3076, 0, 1, int{place.unit}})
        io::testing::append(keys, number);
    las.add_vlr("LASF_Projection", 34735, keys);
    las.add_vlr("LASF_Spec", 4,
                io::testing::extra_descriptor(9, "deviation") + io::testing::extra_descriptor(4, "pulse"));
    for (int32_t i = 0; i < 500; ++i) {
        const int32_t x = i * 7919 % 100'003, y = i * 104'729 % 99'991, z = -i * 13;
        std::string record =
            format == 7 ? io::testing::record6(x, y, z, static_cast<uint16_t>(i * 131), 0x21, 0x53,
                                               static_cast<uint8_t>(i), 7, static_cast<int16_t>(i - 250),
                                               static_cast<uint16_t>(60'000 + i), 1e5 + i / 3.0)
                        : io::testing::record0(x, y, z, static_cast<uint16_t>(i * 131), 0x51,
                                               static_cast<uint8_t>(i % 32), static_cast<int8_t>(i % 90 - 45),
                                               9, static_cast<uint16_t>(i));
        if (format == 7) record += io::testing::rgb(static_cast<uint16_t>(i * 131), 65535, 0);
        record += io::testing::raw(static_cast<float>(i) / 7.0f) + io::testing::raw(static_cast<int16_t>(-i));
        las.records.push_back(record);
    }
    return las;
}

TEST(RoundTrip, ThroughACacheAndEveryFormatKeepsEveryDigitAndEveryAttribute) {
    const TemporaryFolder folder;
    for (const Coordinates& place : kPlaces)
        for (const uint8_t format : {uint8_t{0}, uint8_t{7}}) {
            SCOPED_TRACE(fmt::format("{}, point format {}", place.name, format));
            const auto file = folder / fmt::format("{}.las", format);
            fs::remove(file);
            io::testing::write_bytes(file, scan_of(place, format).bytes());
            expect_round_trips(file, kAll);
        }
}

TEST(RoundTrip, OfTheSharedScansKeepsThemAsWell) {
    const auto shared = io::testing::shared_data();
    if (shared.empty()) GTEST_SKIP() << "the shared data is not here";
    for (const char* name : {"las/1.2-with-color.copc.laz", "las/extrabytes.las", "las/5points_14.las"})
        expect_round_trips(shared / name, kAll);
    expect_round_trips(shared / "las/test1_4.las", kAll);  // a scale that is not a decimal fraction
    for (const char* name : {"ply/ankylosaurus_ascii_rgb_normals.ply", "ply/text_extradim.ply",
                             "e57/bunnyInt19.e57", "ptx_pts/multiple-and-transform.ptx"})
        expect_round_trips(shared / name, kFloating);
}

TEST(RoundTrip, LightGetsMetresWhereTheCacheKeepsFeet) {
    const TemporaryFolder folder;
    io::testing::write_bytes(folder / "a.las", scan_of(kPlaces[2], 0).bytes());
    const auto scan = io::open_scan(folder / "a.las");
    ASSERT_TRUE(scan) << scan.error().line();
    BuildOptions options;
    options.inputs = {scan->get()};
    options.output = folder / "a.luc";
    options.normals = NormalsMode::none;
    ASSERT_TRUE(build_cache(options));
    const auto cache = open_cache(options.output);
    ASSERT_TRUE(cache);
    EXPECT_EQ((*cache)->header().metres_per_unit, 1200.0 / 3937.0);
    EXPECT_GE((*cache)->header().min.x, 636'000.0);  // feet, as in the file
}

}  // namespace
}  // namespace lucarne::octree
