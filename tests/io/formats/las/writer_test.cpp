// Writers: values without a field are kept, values that cannot be stored are an error, and no partial file is
// left.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "io/formats/notes_json.h"
#include "tests/io/formats/las/las_builder.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using namespace testing;  // NOLINT: the builder's small functions
using ::testing::HasSubstr;

/// Records of a schema, filled in by hand.
class Points {
 public:
    explicit Points(PositionType position) {
        schema.position = position;
        schema.stride = static_cast<uint32_t>(position_bytes(position));
    }
    std::byte* add() {
        bytes.resize(bytes.size() + schema.stride);
        return &bytes[bytes.size() - schema.stride];
    }
    template <class T>
    void set(std::string_view name, T value, size_t component = 0) {
        store(&bytes[bytes.size() - schema.stride + schema.find(name)->offset + component * sizeof value],
              value);
    }
    Schema schema;
    std::vector<std::byte> bytes;
};

class Writers : public ::testing::Test {
 protected:
    Result<void> write(const std::string& name, const Points& points, const ScanInfo& info = {},
                       const WriteOptions& options = {}) {
        LUCARNE_ASSIGN(const auto writer, create_scan(folder_ / name, points.schema, info, options));
        LUCARNE_TRY(writer->write(points.bytes));
        return writer->finish();
    }
    std::unique_ptr<PointSource> written(const std::string& name, const Points& points,
                                         const ScanInfo& info = {}, const WriteOptions& options = {}) {
        const auto result = write(name, points, info, options);
        if (!result) {
            ADD_FAILURE() << result.error().line();
            return nullptr;
        }
        auto source = open_scan(folder_ / name);
        if (!source) ADD_FAILURE() << source.error().line();
        return source ? std::move(*source) : nullptr;
    }
    double value(const PointSource& source, std::string_view name, size_t component = 0) const {
        const Attribute* a = source.schema().find(name);
        const auto all = read_all(source);
        if (!a || !all || all->count == 0) {
            ADD_FAILURE() << "no " << name;
            return std::nan("");
        }
        return scalar_at(a->type, &all->bytes[a->offset + component * scalar_bytes(a->type)]);
    }
    const TemporaryFolder folder_;
};

Points floats(std::initializer_list<glm::vec3> positions) {
    Points points(PositionType::f32);
    for (const glm::vec3& p : positions) {
        std::byte* at = points.add();
        for (int axis = 0; axis < 3; ++axis) store(at + 4 * axis, p[axis]);
    }
    return points;
}

TEST_F(Writers, TheLasPointFormatIsTheSmallestWithAFieldForEveryAttribute) {
    const std::vector<std::pair<std::vector<std::string_view>, std::string>> cases = {
        {{}, "LAS 1.2, point format 0"},
        {{names::gps_time}, "LAS 1.2, point format 1"},
        {{names::color, names::intensity, names::point_source_id}, "LAS 1.2, point format 2"},
        {{names::color, names::gps_time, names::scan_angle_rank, names::classification},
         "LAS 1.2, point format 3"},
        {{names::classification}, "LAS 1.4, point format 6"},
        {{names::return_number, names::color}, "LAS 1.4, point format 7"},
        {{names::nir}, "LAS 1.4, point format 8"}};
    for (size_t i = 0; i < cases.size(); ++i) {
        Points points(PositionType::i32_scaled);
        for (const auto name : cases[i].first) {
            const auto type = name == names::gps_time          ? ScalarType::f64
                              : name == names::scan_angle_rank ? ScalarType::i8
                              : name == names::color           ? ScalarType::u16
                                                               : ScalarType::u8;
            points.schema.add(std::string(name), type, name == names::color ? 3 : 1);
        }
        points.add();
        const auto source = written(std::to_string(i) + ".las", points);
        EXPECT_EQ(source->info().format, cases[i].second);
        const std::string bytes = read_bytes(folder_ / (std::to_string(i) + ".las"));
        constexpr size_t kRecordBytes[] = {20, 28, 26, 34, 30, 36, 38};
        EXPECT_EQ(static_cast<unsigned char>(bytes[105]), kRecordBytes[i]);  // no extra bytes
    }
}

TEST_F(Writers, TheLasHeaderSaysTheTruthAboutThePoints) {
    Points points(PositionType::i32_scaled);
    points.schema.scale = {0.5, -2.0, 0.25};
    points.schema.offset = {10, 0, -1};
    points.schema.add(std::string(names::return_number), ScalarType::u8);
    for (const int i : {-4, 6, 2}) {
        std::byte* at = points.add();
        for (int axis = 0; axis < 3; ++axis) store(at + 4 * axis, i);
        points.set(names::return_number, static_cast<uint8_t>(i == 6 ? 2 : 1));
    }
    ASSERT_TRUE(written("a.las", points));
    const std::string bytes = read_bytes(folder_ / "a.las");
    const auto* b = reinterpret_cast<const std::byte*>(bytes.data());
    const double expected[] = {13, 8, 8, -12, 0.5, -2};  // largest and smallest x, y, z
    for (size_t i = 0; i < 6; ++i) EXPECT_EQ(load<double>(b + 179 + 8 * i), expected[i]) << i;
    EXPECT_EQ(load<uint16_t>(b + 94), 375);
    EXPECT_EQ(load<uint32_t>(b + 107), 0u);  // the old count is 0 for point formats 6 and up
    EXPECT_EQ(load<uint64_t>(b + 247), 3u);
    EXPECT_EQ(load<uint64_t>(b + 255), 2u);
    EXPECT_EQ(load<uint64_t>(b + 263), 1u);
    EXPECT_EQ(bytes.size(), load<uint32_t>(b + 96) + 3u * load<uint16_t>(b + 105));
}

TEST_F(Writers, WhatALasFieldCannotHoldGoesToExtraBytes) {
    Points points(PositionType::i32_scaled);
    points.schema.add("intensity", ScalarType::f32);
    points.schema.add("curvature", ScalarType::f64);
    points.schema.add("normal", ScalarType::f32, 3);
    points.schema.add("code", ScalarType::u8, 5);
    points.schema.add("stamp", ScalarType::u64);
    points.add();
    points.set("intensity", 0.75f);
    points.set("curvature", 0.1);
    for (size_t c = 0; c < 3; ++c) points.set("normal", static_cast<float>(c) + 0.5f, c);
    for (size_t c = 0; c < 5; ++c) points.set("code", static_cast<uint8_t>(c), c);
    points.set("stamp", uint64_t{0xfedcba9876543210});
    const auto source = written("a.las", points);
    EXPECT_EQ(value(*source, "intensity"), 0.75);
    EXPECT_EQ(value(*source, "las_intensity"), 1);  // rounded, for other programs
    EXPECT_EQ(value(*source, "curvature"), 0.1);
    EXPECT_EQ(value(*source, "normal", 2), 2.5);
    EXPECT_EQ(value(*source, "code", 4), 4);
    const auto all = read_all(*source);
    EXPECT_EQ(load<uint64_t>(&all->bytes[source->schema().find("stamp")->offset]), 0xfedcba9876543210u);
}

/// Returns the names of extra bytes as they are in a LAS file.
std::vector<std::string> names_in_file(const std::string& bytes) {
    std::vector<std::string> names;
    const auto* b = reinterpret_cast<const std::byte*>(bytes.data());
    size_t at = load<uint16_t>(b + 94);
    for (uint32_t left = load<uint32_t>(b + 100); left > 0; --left) {
        const size_t length = load<uint16_t>(b + at + 20), data = at + 54;
        const bool extra = bytes.compare(at + 2, 10, std::string("LASF_Spec\0", 10)) == 0 &&
                           load<uint16_t>(b + at + 18) == 4;
        for (size_t entry = data; extra && entry < data + length; entry += 192)
            names.emplace_back(bytes.substr(entry + 4, 32).c_str());
        at = data + length;
    }
    return names;
}

TEST_F(Writers, NoExtraOfALasFileIsCalledLikeAFieldAndAllComeBackUnderTheirNames) {
    Points points(PositionType::i32_scaled);
    for (const char* name : {"intensity", "return_number", "gps_time", "red", "Classification", "curvature"})
        points.schema.add(name, name == std::string("intensity") ? ScalarType::f32 : ScalarType::i64);
    points.add();
    points.set("intensity", 0.75f);
    points.set("return_number", int64_t{200});
    points.set("gps_time", int64_t{-5});
    points.set("red", int64_t{3});
    ScanInfo info;
    info.notes.intensity_limits = {0.5, 1.0};
    for (const char* name : {"a.las", "a.laz"}) {
        const auto source = written(name, points, info);
        EXPECT_THAT(
            names_in_file(read_bytes(folder_ / name)),
            ::testing::ElementsAre("original_intensity", "original_return_number", "original_gps_time",
                                   "original_red", "original_Classification", "curvature"));
        EXPECT_EQ(value(*source, "intensity"), 0.75);
        EXPECT_EQ(value(*source, "las_intensity"), 32768);  // the middle of its limits
        EXPECT_EQ(value(*source, "return_number"), 200);
        EXPECT_EQ(value(*source, "las_return_number"), 15);  // the largest value of 4 bits
        EXPECT_EQ(value(*source, "las_gps_time"), -5);
        EXPECT_EQ(value(*source, "red"), 3);
        const auto all = read_all(*source);  // all values read back unchanged
        const auto again =
            create_scan(folder_ / (std::string("b") + name), source->schema(), source->info(), {});
        ASSERT_TRUE(again && (*again)->write(all->bytes) && (*again)->finish());
        EXPECT_EQ(read_bytes(folder_ / (std::string("b") + name)), read_bytes(folder_ / name));
    }
}

TEST_F(Writers, AnIntensityWithoutLimitsIsSpreadFromWhatItIsUnlessItFits) {
    struct Case {
        float low, high;
        double expected;  ///< expected for the highest intensity
    };
    for (const Case& c : {Case{0.25f, 0.5f, 65535}, Case{-2048, 2047, 65535}, Case{0, 300, 300}}) {
        Points points(PositionType::i32_scaled);
        points.schema.add("intensity", ScalarType::f32);
        for (const float v : {c.high, c.low}) {
            points.add();
            points.set("intensity", v);
        }
        WriteOptions options{.overwrite = true};
        options.preview = [&](const auto& visit) -> Result<void> {
            visit(points.bytes);
            return {};
        };
        EXPECT_EQ(value(*written("a.las", points, {}, options), "las_intensity"), c.expected);
    }
}

/// Writes the scan with an additional infrared attribute, for which older point formats have no field, and
/// opens it.
std::unique_ptr<PointSource> with_infrared(const PointSource& scan, const std::filesystem::path& path) {
    Schema schema = scan.schema();
    schema.add(std::string(names::nir), ScalarType::u16);
    auto records = read_all(scan)->bytes;
    for (size_t at = scan.schema().stride; at <= records.size(); at += schema.stride)
        records.insert(records.begin() + static_cast<std::ptrdiff_t>(at), 2, std::byte{1});
    const auto writer = create_scan(path, schema, scan.info(), {.overwrite = true});
    if (!writer || !(*writer)->write(records) || !(*writer)->finish()) return nullptr;
    auto copy = open_scan(path);
    return copy ? std::move(*copy) : nullptr;
}

TEST_F(Writers, ScanAnglesInWholeDegreesFillTheFieldOfNewerFormatsAndStay) {
    LasFile file;
    file.format = 1;
    file.records = {record0(1, 2, 3, 0, 0, 0, -90) + testing::raw(0.0)};
    write_bytes(folder_ / "old.las", file.bytes());
    const auto source = open_scan(folder_ / "old.las");
    ASSERT_TRUE(source);
    for (const std::string name : {"new.las", "new.laz"}) {
        const auto copy = with_infrared(**source, folder_ / name);
        ASSERT_TRUE(copy);
        EXPECT_EQ(value(*copy, "scan_angle"), -15000);  // units of 0.006 degrees
        EXPECT_EQ(value(*copy, "scan_angle_rank"), -90);
    }
}

TEST_F(Writers, ScanAnglesOfOlderAndNewerFormatsFillOneField) {
    Points points(PositionType::f64);  // as when two scans were merged
    points.schema.add(std::string(names::scan_angle_rank), ScalarType::i8);
    points.schema.add(std::string(names::scan_angle), ScalarType::i16);
    points.add();
    points.set(names::scan_angle_rank, int8_t{12});
    EXPECT_EQ(value(*written("a.las", points), "scan_angle"), 2000);
    points.set(names::scan_angle_rank, int8_t{0});
    points.set(names::scan_angle, int16_t{-501});
    EXPECT_EQ(value(*written("b.las", points), "scan_angle"), -501);
}

TEST_F(Writers, GeoTiffKeysOfUtmBecomeWellKnownTextInNewerFormatsAndOthersStay) {
    for (const uint16_t code : {uint16_t{32633}, uint16_t{2903}}) {
        LasFile file;
        file.records = {record0(1, 2, 3)};
        std::string keys;
        for (const uint16_t n : {1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, static_cast<int>(code)})
            testing::append(keys, n);
        file.add_vlr("LASF_Projection", 34735, keys);
        write_bytes(folder_ / "old.las", file.bytes());
        const auto source = open_scan(folder_ / "old.las");
        ASSERT_TRUE(source);
        for (const std::string name : {"new.laz", "new.las", "same.laz", "same.las"}) {
            const bool is_new = name.starts_with("new");
            if (is_new) {
                ASSERT_TRUE(with_infrared(**source, folder_ / name));
            } else {
                const auto all = read_all(**source);
                const auto writer =
                    create_scan(folder_ / name, (*source)->schema(), (*source)->info(), {.overwrite = true});
                ASSERT_TRUE(writer && (*writer)->write(all->bytes) && (*writer)->finish());
            }
            const std::string bytes = read_bytes(folder_ / name);
            EXPECT_EQ(bytes.find("PROJCS[") != bytes.npos, code == 32633 && is_new) << name;
            EXPECT_EQ((bytes[6] & 16) != 0, is_new);
            const auto copy = open_scan(folder_ / name);
            ASSERT_TRUE(copy);
            EXPECT_EQ((*copy)->info().epsg, code);
        }
    }
}

TEST_F(Writers, GeoTiffKeysOfUtmInAUnitOfTheirOwnStayKeys) {
    LasFile file;
    file.records = {record0(1, 2, 3)};
    std::string keys;
    for (const uint16_t n : {1, 1, 0, 3, 3072, 0, 1, 32633, 3076, 0, 1, 32767, 3077, 34736, 1, 0})
        testing::append(keys, n);
    file.add_vlr("LASF_Projection", 34735, keys);
    file.add_vlr("LASF_Projection", 34736, raw(0.25));
    write_bytes(folder_ / "old.las", file.bytes());
    const auto source = open_scan(folder_ / "old.las");
    ASSERT_TRUE(source) << source.error().line();
    const auto copy = with_infrared(**source, folder_ / "new.laz");
    ASSERT_TRUE(copy);
    EXPECT_EQ(copy->info().metres_per_unit, .25);
    const std::string bytes = read_bytes(folder_ / "new.laz");
    EXPECT_EQ(bytes.find("PROJCS["), bytes.npos);
}

TEST_F(Writers, ExtraBytesWhoseNamesWereTakenKeepTheirScales) {
    testing::LasFile las;
    const auto scaled = [](const char* name, double scale) {
        std::string entry = extra_descriptor(3, name, 8);  // u16, with a valid scale
        put(entry, 112, scale);
        return entry;
    };
    las.add_vlr("LASF_Spec", 4, scaled("Amp", 0.01) + scaled("Amp", 0.5) + scaled("intensity", 0.25));
    las.records = {record0(1, 2, 3) + raw<uint16_t>(10) + raw<uint16_t>(20) + raw<uint16_t>(30)};
    write_bytes(folder_ / "in.las", las.bytes());
    const auto in = open_scan(folder_ / "in.las");
    ASSERT_TRUE(in) << in.error().line();
    Points points(PositionType::i32_scaled);
    points.schema = (*in)->schema();
    points.bytes = read_all(**in)->bytes;
    for (const char* name : {"out.las", "out.laz"}) {
        const auto out = written(name, points, (*in)->info());
        EXPECT_EQ(value(*out, "Amp_2"), 20);
        EXPECT_EQ(value(*out, "intensity_2"), 30);
        const std::string bytes = read_bytes(folder_ / name);
        for (const auto& [entry, scale] : {std::pair("Amp", 0.01), {"Amp_2", 0.5}, {"intensity_2", 0.25}}) {
            const size_t at = bytes.find(extra_descriptor(3, entry, 8).substr(0, 36));
            ASSERT_NE(at, std::string::npos) << entry;
            EXPECT_EQ(load<double>(reinterpret_cast<const std::byte*>(&bytes[at + 112])), scale) << entry;
        }
    }
}

TEST_F(Writers, ColoursOfAnyTypeAreSpreadOver16BitsInLas) {
    struct Case {
        ScalarType type;
        uint32_t bits;
        double white;
    };
    for (const Case& c :
         {Case{ScalarType::u8, 8, 255}, Case{ScalarType::f32, 0, 1}, Case{ScalarType::f64, 8, 255},
          Case{ScalarType::u16, 16, 65535}, Case{ScalarType::u16, 8, 255}}) {
        Points points(PositionType::i32_scaled);
        points.schema.add(std::string(names::color), c.type, 3);
        store_scalar(c.type, points.add() + 12, c.white);
        ScanInfo info;
        info.color_bits = c.bits;
        WriteOptions options;
        options.overwrite = true;
        const auto source = written("a.las", points, info, options);
        EXPECT_EQ(value(*source, names::color, 0), 65535);
        EXPECT_EQ(value(*source, names::color, 1), 0);
    }
    Points small(PositionType::i32_scaled);
    small.schema.add(std::string(names::color), ScalarType::u16, 3);
    small.add();
    small.set(names::color, uint16_t{255});
    ScanInfo las;
    las.notes.las.emplace().point_format = 2;
    EXPECT_EQ(value(*written("b.las", small, las), names::color), 255)
        << "those of a LAS file stay as they are";
}

TEST_F(Writers, FloatPositionsGetTheFinestScaleTheirBoxAllows) {
    const Points points = floats({{-20.123456f, 3, 0.25f}, {20, 4, 0.5f}});
    WriteOptions options;
    options.bounds = {{glm::dvec3(-20.2, 3, 0), glm::dvec3(20, 4, 1)}};
    const auto source = written("a.las", points, {}, options);
    EXPECT_DOUBLE_EQ(source->schema().scale.x, 1e-8);
    const auto all = read_all(*source);
    EXPECT_NEAR(position_of(source->schema(), all->bytes.data()).x, double{-20.123456f}, 0.51e-8);
}

TEST_F(Writers, APositionBeyondTheIntegersOfLasIsAnError) {
    const auto result = write("a.las", floats({{1, 2, 3}, {3e8f, 0, 0}}));
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().line(), HasSubstr("does not fit"));
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(Writers, AClassBeyondTheBitsOfItsFieldIsAnErrorAndNotAnotherClass) {
    LasFile file;
    file.records = {record0(1, 2, 3)};
    write_bytes(folder_ / "old.las", file.bytes());
    const auto source = open_scan(folder_ / "old.las");
    ASSERT_TRUE(source);
    auto all = read_all(**source);
    store<uint8_t>(&all->bytes[(*source)->schema().find(names::classification)->offset], 32);
    const auto writer = create_scan(folder_ / "new.las", (*source)->schema(), (*source)->info(), {});
    ASSERT_TRUE(writer);
    const auto result = (*writer)->write(all->bytes);
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().line(), HasSubstr("does not fit point format 0"));
}

TEST_F(Writers, A64BitIntegerBecomesTwoPropertiesInPly) {
    Points points(PositionType::f64);
    points.schema.add("stamp", ScalarType::i64);
    points.schema.add("two words", ScalarType::u8);
    points.add();
    points.set("stamp", int64_t{-2});
    points.set("two words", uint8_t{9});
    const auto source = written("a.ply", points);
    EXPECT_EQ(value(*source, "stamp_low"), 4294967294.0);
    EXPECT_EQ(value(*source, "stamp_high"), -1);
    EXPECT_EQ(value(*source, "two_words"), 9);
}

TEST_F(Writers, ScaledCoordinatesLeaveAsTheFractionsThatTheyStandFor) {
    Points points(PositionType::i32_scaled);
    points.schema.scale = {0.01, 0.001, 0.01};
    points.schema.offset = {0, 2'600'000, 0};
    const std::array<int32_t, 3> steps = {35, 1, 63600176};
    std::byte* at = points.add();
    for (size_t axis = 0; axis < 3; ++axis) store(at + 4 * axis, steps[axis]);
    ASSERT_NE(35 * 0.01, 0.35) << "what it is about";
    for (const std::string name : {"a.ply", "a.pcd"}) {
        const auto source = written(name, points);
        ASSERT_TRUE(source);
        const auto all = read_all(*source);
        ASSERT_TRUE(all) << all.error().line();
        ASSERT_EQ(source->schema().position, PositionType::f64);
        EXPECT_EQ(position_of(source->schema(), all->bytes.data()),
                  glm::dvec3(0.35, 2'600'000.001, 636001.76))
            << name;
    }
    points.schema.scale = glm::dvec3(1.0 / 3);  // no decimal fraction
    points.schema.offset = glm::dvec3(0.1);
    const auto source = written("b.ply", points);
    ASSERT_TRUE(source);
    EXPECT_EQ(position_of(source->schema(), read_all(*source)->bytes.data()).x, 35 * (1.0 / 3) + 0.1);
}

TEST_F(Writers, StationsUnitsAndColourBitsSurviveInBothFormats) {
    ScanInfo info;
    info.color_bits = 16;
    info.stations = {{1, {1.5, -2.25, 1e6}}, {65535, {0.1, 0.2, 0.3}}};
    Points points(PositionType::i32_scaled);
    points.schema.add(std::string(names::color), ScalarType::u16, 3);
    points.add();
    points.set(names::color, uint16_t{40000});
    for (const char* name : {"a.las", "a.ply"}) {
        const auto source = written(name, points, info);
        ASSERT_EQ(source->info().stations.size(), 2u) << name;
        for (size_t i = 0; i < 2; ++i) {
            EXPECT_EQ(source->info().stations[i].id, info.stations[i].id);
            EXPECT_EQ(source->info().stations[i].position, info.stations[i].position);
        }
        EXPECT_EQ(source->info().color_bits, 16u);
    }
    for (const double unit : {0.3048, 1200.0 / 3937.0, 0.001, 1000.0}) {
        info.metres_per_unit = unit;
        for (const char* name : {"b.ply", "b.las", "b.laz"})
            EXPECT_EQ(written(name, points, info, {.overwrite = true})->info().metres_per_unit, unit) << name;
    }
}

TEST_F(Writers, ACoordinateSystemOfItsOwnIsKeptWhateverUnitAScanWasReadIn) {
    testing::LasFile las;
    las.minor = 4;
    las.encoding = 16;
    las.format = 6;
    las.records = {record6(1, 2, 3, 0, 0x11, 0, 0, 0, 0, 0, 0)};
    las.add_vlr("LASF_Projection", 2112, R"(PROJCS["here",UNIT["metre",1]])");
    write_bytes(folder_ / "in.las", las.bytes());
    const auto in = open_scan(folder_ / "in.las", {.metres_per_unit = 0.3048});
    ASSERT_TRUE(in) << in.error().line();
    EXPECT_EQ((*in)->info().metres_per_unit, 0.3048);
    Points points(PositionType::i32_scaled);
    points.add();
    const auto out = written("out.las", points, (*in)->info());
    EXPECT_EQ(out->info().coordinate_system, "here");
    EXPECT_EQ(out->info().metres_per_unit, 1.0);
}

TEST_F(Writers, ManyStationsTakeALargerLasVersion) {
    ScanInfo info;
    for (uint32_t i = 0; i < 3000; ++i) info.stations.push_back({i, {i * 0.1, 2, 3}});
    const auto source = written("a.las", floats({{1, 2, 3}}), info);
    EXPECT_EQ(source->info().format, "LAS 1.4, point format 0");
    EXPECT_EQ(source->info().stations.size(), 3000u);
}

TEST_F(Writers, NoPointsMakeAValidFile) {
    for (const char* name : {"a.las", "a.ply"}) {
        const auto source = written(name, floats({}));
        ASSERT_TRUE(source);
        EXPECT_EQ(read_all(*source)->count, 0u);
    }
}

TEST_F(Writers, AnUnfinishedFileLeavesNothing) {
    for (const char* name : {"a.las", "a.ply"}) {
        const Points points = floats({{1, 2, 3}});
        const auto writer = create_scan(folder_ / name, points.schema, {}, {});
        ASSERT_TRUE(writer);
        ASSERT_TRUE((*writer)->write(points.bytes));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(Writers, AnExistingFileAndAnUnknownExtensionAreRefused) {
    write_bytes(folder_ / "a.las", "mine");
    const Points points = floats({{1, 2, 3}});
    EXPECT_EQ(write("a.las", points).error().kind, ErrorKind::failed);
    EXPECT_EQ(read_bytes(folder_ / "a.las"), "mine");
    const auto unknown = write("a.zyx", points);
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().kind, ErrorKind::arguments);
    EXPECT_TRUE(write("B.LAS", points));
}

TEST_F(Writers, DamagedDetailsAreAnErrorOrIgnoredButNeverACrash) {
    const Points points = floats({{1, 2, 3}});
    for (const char* details :
         {"", "[", "[]", "7", R"({"format":7})", R"({"format":"las"})",
          R"({"format":"las","point_format":-1})", R"({"format":"ply"})",
          R"({"format":"ply","properties":[1]})",
          R"({"format":"ply","properties":[{"name":"x","type":"quux"}]})",
          R"({"format":"ply","properties":[{"name":"a b\n","type":"int"}],"comments":[3,"x\ny"]})"}) {
        ScanInfo info;
        info.notes = notes_of_text(details);
        WriteOptions options;
        options.overwrite = true;
        const auto las = write("a.las", points, info, options);
        const auto ply = write("a.ply", points, info, options);
        EXPECT_TRUE(ply) << details;
        if (!las) {
            EXPECT_THAT(las.error().line(), HasSubstr("is damaged"));
        }
        EXPECT_EQ(las.has_value(), std::string_view(details).find("\"las\"") == std::string_view::npos)
            << details;
    }
}

TEST_F(Writers, ColoursBesideAnOldHeaderTakeAVersionThatHasThem) {
    for (const uint8_t minor : {uint8_t{0}, uint8_t{1}}) {
        LasFile old;
        old.minor = minor;
        old.records = {record0(1, 2, 3)};
        write_bytes(folder_ / "old.las", old.bytes());
        Points points(PositionType::i32_scaled);
        points.schema.add(std::string(names::color), ScalarType::u16, 3);
        points.add();
        const auto source = open_scan(folder_ / "old.las");
        const auto copy = written("new.las", points, (*source)->info(), {.overwrite = true});
        EXPECT_EQ(copy->info().format, "LAS 1.2, point format 2");
    }
}

TEST_F(Writers, HeadersOfEveryLasVersionComeBack) {
    for (const int minor : {0, 1, 2, 3, 4}) {
        LasFile file;
        file.minor = static_cast<uint8_t>(minor);
        file.add_vlr("someone", 7, "data of a record");
        file.records = {record0(1, 2, 3) + "xy", record0(4, 5, 6) + "zw"};
        write_bytes(folder_ / "a.las", file.bytes());
        const auto source = open_scan(folder_ / "a.las");
        ASSERT_TRUE(source);
        const auto all = read_all(**source);
        const auto writer =
            create_scan(folder_ / "b.las", (*source)->schema(), (*source)->info(), {true, 0, {}});
        ASSERT_TRUE(writer && (*writer)->write(all->bytes) && (*writer)->finish());
        const auto copy = open_scan(folder_ / "b.las");
        ASSERT_TRUE(copy) << copy.error().line();
        EXPECT_TRUE((*copy)->info().notes == (*source)->info().notes) << minor;
        EXPECT_TRUE(read_all(**copy)->bytes == all->bytes) << minor;
    }
}

}  // namespace
}  // namespace lucarne::io
