// The LAS reader returns what a file says, and rejects what makes no sense.
#include <cmath>
#include <limits>
#include <map>

#include <gmock/gmock.h>

#include "io/core/random.h"
#include "io/formats/las/bounds.h"
#include "io/formats/notes_json.h"
#include "tests/io/formats/las/las_builder.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using namespace testing;  // NOLINT: the builder's small functions
using ::testing::HasSubstr;

class Las : public ::testing::Test {
 protected:
    std::unique_ptr<PointSource> open(const LasFile& file) {
        auto source = open_bytes(file.bytes());
        if (!source) ADD_FAILURE() << source.error().line();
        return source ? std::move(*source) : nullptr;
    }
    Result<std::unique_ptr<PointSource>> open_bytes(const std::string& bytes) {
        file_.set(bytes);  // without an extension in its name, only the content tells the format
        return open_scan(file_.path());
    }
    void expect_rejected(const LasFile& file, const std::string& reason) {
        const auto source = open_bytes(file.bytes());
        ASSERT_FALSE(source) << reason;
        EXPECT_EQ(source.error().kind, ErrorKind::input_rejected);
        EXPECT_THAT(source.error().line(), HasSubstr(reason));
    }
    const MemoryFile file_;
};

/// Returns a value of a record, by default the first.
double value(const PointSource& source, std::string_view name, size_t component = 0, size_t record = 0) {
    const Attribute* a = source.schema().find(name);
    const auto all = read_all(source);
    if (!a || !all || all->count <= record) {
        ADD_FAILURE() << "no " << name;
        return std::nan("");
    }
    return scalar_at(
        a->type,
        &all->bytes[record * source.schema().stride + a->offset + component * scalar_bytes(a->type)]);
}

TEST_F(Las, EveryBitOfAnOldRecordIsUnpacked) {
    LasFile file;
    // Return 5 of 6, backward scan, edge of flight line; class 19, synthetic and withheld.
    file.records.push_back(
        record0(100, -200, 300, 40000, 5 | 6 << 3 | 1 << 6 | 1 << 7, 19 | 1 << 5 | 1 << 7, -90, 77, 4711));
    file.scale[1] = 0.5;
    file.offset[1] = 1000;
    const auto source = open(file);
    const std::map<std::string_view, double> expected = {
        {names::intensity, 40000},     {names::return_number, 5},       {names::number_of_returns, 6},
        {names::scan_direction, 1},    {names::edge_of_flight_line, 1}, {names::classification, 19},
        {names::class_flags, 5},       {names::scan_angle_rank, -90},   {names::user_data, 77},
        {names::point_source_id, 4711}};
    EXPECT_EQ(source->schema().attributes.size(), expected.size());
    for (const auto& [name, number] : expected) EXPECT_EQ(value(*source, name), number) << name;
    EXPECT_EQ(source->schema().position, PositionType::i32_scaled);
    const auto all = read_all(*source);
    EXPECT_EQ(load<int32_t>(&all->bytes[4]), -200);
    EXPECT_EQ(position_of(source->schema(), all->bytes.data()), glm::dvec3(1.0, 900.0, 3.0));
    EXPECT_EQ(source->info().format, "LAS 1.2, point format 0");
}

TEST_F(Las, EveryBitOfANewRecordIsUnpacked) {
    LasFile file;
    file.minor = 4;
    file.format = 8;
    // Return 11 of 15; flags 9, channel 2, backward scan, edge of flight line.
    file.records.push_back(
        record6(1, 2, 3, 65535, 11 | 15 << 4, 9 | 2 << 4 | 1 << 6 | 1 << 7, 200, 8, -30000, 65535, 1.5e9) +
        rgb(1000, 2000, 3000) + raw<uint16_t>(4000));
    const auto source = open(file);
    const std::map<std::string_view, double> expected = {{names::intensity, 65535},
                                                         {names::return_number, 11},
                                                         {names::number_of_returns, 15},
                                                         {names::class_flags, 9},
                                                         {names::scanner_channel, 2},
                                                         {names::scan_direction, 1},
                                                         {names::edge_of_flight_line, 1},
                                                         {names::classification, 200},
                                                         {names::user_data, 8},
                                                         {names::scan_angle, -30000},
                                                         {names::point_source_id, 65535},
                                                         {names::gps_time, 1.5e9},
                                                         {names::color, 1000},
                                                         {names::nir, 4000}};
    EXPECT_EQ(source->schema().attributes.size(), expected.size());
    for (const auto& [name, number] : expected) EXPECT_EQ(value(*source, name), number) << name;
    EXPECT_EQ(value(*source, names::color, 2), 3000);
}

TEST_F(Las, TimeAndColourOfTheOtherFormatsStandWhereTheSpecificationSays) {
    const std::string time = raw(123.25), color = rgb(256, 2, 3);
    const std::string old = record0(1, 2, 3), fresh = record6(1, 2, 3, 0, 0, 0, 0, 0, 0, 0, 123.25);
    const std::map<uint8_t, std::string> records = {
        {1, old + time}, {2, old + color}, {3, old + time + color}, {6, fresh}, {7, fresh + color}};
    for (const auto& [format, record] : records) {
        LasFile file;
        file.minor = format >= 6 ? 4 : 3;
        file.format = format;
        file.records = {record, record};
        const auto source = open(file);
        if (format != 2) {
            EXPECT_EQ(value(*source, names::gps_time, 0, 1), 123.25) << int{format};
        }
        if (format != 1 && format != 6) {
            EXPECT_EQ(value(*source, names::color, 0, 1), 256) << int{format};
        }
    }
}

TEST_F(Las, ATimeThatIsNoNumberKeepsThePoint) {
    LasFile file;
    file.format = 1;
    file.records = {record0(1, 2, 3) + raw(std::nan(""))};
    const auto source = open(file);
    EXPECT_TRUE(std::isnan(value(*source, names::gps_time)));
    EXPECT_EQ(read_all(*source)->dropped, 0u);
}

TEST_F(Las, ExtraBytesBecomeTypedAttributesByName) {
    LasFile file;
    std::string descriptors = extra_descriptor(3, "echo width") + extra_descriptor(10, "range") +
                              extra_descriptor(29, "direction") + extra_descriptor(0, "blob", 3) +
                              extra_descriptor(1, "intensity");
    file.add_vlr("LASF_Spec", 4, descriptors);
    std::string record = record0(1, 2, 3, 500) + raw<uint16_t>(1234) + raw(0.1);
    for (const float f : {1.f, 2.f, 3.f}) record += raw(f);
    file.records = {record + "abc" + "\x07" + "zz"};
    const auto source = open(file);
    EXPECT_EQ(value(*source, "echo width"), 1234);
    EXPECT_EQ(value(*source, "range"), 0.1);
    EXPECT_EQ(source->schema().find("direction")->type, ScalarType::f32);
    EXPECT_EQ(value(*source, "direction", 2), 3);
    EXPECT_EQ(source->schema().find("blob")->components, 3u);
    EXPECT_EQ(value(*source, "blob", 1), 'b');
    EXPECT_EQ(value(*source, "intensity"), 500);  // the field of the point format
    EXPECT_EQ(value(*source, "intensity_2"), 7);  // the extra byte of the same name
    EXPECT_EQ(source->schema().find("extra_bytes")->components, 2u);
    EXPECT_EQ(value(*source, "extra_bytes", 1), 'z');
}

TEST_F(Las, ExtraBytesNamedAsWhatTheyAreNotAreNothingButExtraBytes) {
    LasFile file;
    file.add_vlr("LASF_Spec", 4, extra_descriptor(0, "nothing") + extra_descriptor(1, "color"));
    file.records = {record0(1, 2, 3) + "\x07", record0(1, 2, 3) + "\x08"};
    const auto source = open(file);
    EXPECT_EQ(value(*source, "color", 0, 1), 8);
    EXPECT_EQ(source->info().color_bits, 8u) << "as nothing was read for it";
}

TEST_F(Las, PointsFarOutsideTheStatedBoxAreTold) {
    const auto header = [&](double low, double high) {
        las::Header h;
        h.scale = glm::dvec3(0.5);
        h.offset = glm::dvec3(10);
        h.low = glm::dvec3(low);
        h.high = glm::dvec3(high);
        return h;
    };
    const auto outside = [](const las::Header& h, int32_t x, int32_t z) {
        const std::string records = raw(0) + raw(0) + raw(0) + raw(x) + raw(0) + raw(z);
        return las::StatedBounds(h)
            .outside(reinterpret_cast<const std::byte*>(records.data()), 2, 12)
            .has_value();
    };
    // 0 to 20 units, and the same length again on each side, are the integers -60 to 60.
    EXPECT_FALSE(outside(header(0, 20), -60, 60));
    EXPECT_TRUE(outside(header(0, 20), -61, 0));
    EXPECT_TRUE(outside(header(0, 20), 0, 61));
    EXPECT_FALSE(outside(header(0, 0), 0, 1 << 30)) << "a box that was never filled in";
    EXPECT_FALSE(outside(header(20, 0), 0, 1 << 30)) << "no box";
    EXPECT_FALSE(outside(header(0, std::nan("")), 0, 1 << 30)) << "no box";
    las::Header mirrored = header(0, 20);
    mirrored.scale.x = -0.5;
    EXPECT_FALSE(outside(mirrored, 60, 0));
    EXPECT_TRUE(outside(mirrored, 61, 0));
}

TEST_F(Las, ExtraBytesThatDoNotFitTheRecordStayBytes) {
    for (const uint8_t type : {uint8_t{10}, uint8_t{0}, uint8_t{77}}) {  // too wide, without a size, unknown
        LasFile file;
        file.add_vlr("LASF_Spec", 4, extra_descriptor(type, "lie") + "half a descriptor");
        file.records = {record0(1, 2, 3) + "xyz"};
        const auto source = open(file);
        EXPECT_FALSE(source->schema().find("lie"));
        EXPECT_EQ(source->schema().find("extra_bytes")->components, 3u);
    }
}

TEST_F(Las, ColourOf8BitsIn16IsToldFromFullColour) {
    LasFile file;
    file.format = 2;
    for (int i = 0; i < 1000; ++i) file.records.push_back(record0(i, i, i) + rgb(255, 128, 0));
    EXPECT_EQ(open(file)->info().color_bits, 8u);
    file.records[998].replace(22, 2, raw<uint16_t>(256));
    const auto full = open(file);
    EXPECT_EQ(full->info().color_bits, 16u);
    EXPECT_EQ(full->info().notes.color_bits, 16);
    EXPECT_EQ(value(*full, names::color, 1, 998), 256);
}

TEST_F(Las, ABrightPointThatTheSampleMissedIsKeptAsItIs) {
    LasFile file;
    file.format = 2;
    for (int i = 0; i < 40000; ++i) file.records.push_back(record0(i, i, i) + rgb(200, 100, 50));
    file.records[300].replace(20, 2, raw<uint16_t>(65535));  // between two sampled blocks
    const auto source = open(file);
    EXPECT_EQ(source->info().color_bits, 8u);
    EXPECT_EQ(value(*source, names::color, 0, 300), 65535);
}

TEST_F(Las, BatchesOfAnySizeGiveTheSameRecords) {
    LasFile file;
    file.format = 3;
    for (int i = 0; i < 5000; ++i)
        file.records.push_back(record0(i, -i, i * i) + raw(i * 0.1) + rgb(1, 2, static_cast<uint16_t>(i)));
    const auto source = open(file);
    const auto whole = read_all(*source, 1'000'000);
    for (const size_t batch : {1, 7, 4096})
        EXPECT_TRUE(read_all(*source, batch)->bytes == whole->bytes) << batch;
    EXPECT_EQ(whole->count, 5000u);
}

TEST_F(Las, NoPointsIsAValidFile) {
    const auto source = open(LasFile{});
    EXPECT_EQ(source->info().declared_points, 0u);
    EXPECT_EQ(read_all(*source)->count, 0u);
}

TEST_F(Las, NewHeadersMayFillOnlyTheOldCount) {
    LasFile file;
    file.minor = 4;
    file.records = {record0(1, 2, 3), record0(4, 5, 6)};
    file.said_points = 0;
    EXPECT_EQ(read_all(*open(file))->count, 2u);
    file.said_points = 2;
    file.said_old_points = 0;
    EXPECT_EQ(read_all(*open(file))->count, 2u);
}

TEST_F(Las, ExtendedRecordsBehindThePointsAreRead) {
    LasFile file;
    file.minor = 4;
    file.records = {record0(1, 2, 3)};
    file.add_vlr("lucarne", 1, R"({"stations":[{"id":3,"position":[1,2.5,-3]}]})", true);
    const auto source = open(file);
    ASSERT_EQ(source->info().stations.size(), 1u);
    EXPECT_EQ(source->info().stations[0].id, 3u);
    EXPECT_EQ(source->info().stations[0].position, glm::dvec3(1, 2.5, -3));
}

TEST_F(Las, StationsThatCannotBeUnderstoodAreRejected) {
    for (const char* json :
         {"", "{", "[]", R"({"stations":3})", R"({"stations":[{"id":-1,"position":[1,2,3]}]})",
          R"({"stations":[{"id":1,"position":[1,2]}]})", R"({"stations":[{"id":1,"position":[1,2,"x"]}]})",
          R"({"stations":[{"id":1,"position":[1,2,1e300]}]})",
          R"({"stations":[{"id":5000000000,"position":[1,2,3]}]})"}) {
        LasFile file;
        file.add_vlr("lucarne", 1, json);
        expect_rejected(file, "station poses");
    }
}

TEST_F(Las, WavePacketsAreSkippedAndTheBytesBehindThemAreNot) {
    const testing::TemporaryFolder folder;
    constexpr size_t kWave = 29;
    for (const auto& [format, same] : {std::pair{4, 1}, {5, 3}, {9, 6}, {10, 8}}) {
        const size_t fields = las::record_bytes(static_cast<uint8_t>(same));
        LasFile plain, waves;
        plain.minor = waves.minor = 4;
        plain.format = static_cast<uint8_t>(same);
        waves.format = static_cast<uint8_t>(format);
        for (int point = 0; point < 5; ++point) {
            std::string record(fields + 3, '\0');
            for (size_t i = 0; i < record.size(); ++i)
                record[i] = static_cast<char>((i * 37 + static_cast<size_t>(point) * 11) & 0x7f);
            plain.records.push_back(record);
            waves.records.push_back(record.insert(fields, std::string(kWave, '\xee')));
        }
        waves.add_vlr("LASF_Spec", 100, std::string(26, 'w'));
        testing::write_bytes(folder / "plain.las", plain.bytes());
        testing::write_bytes(folder / "waves.las", waves.bytes());
        const auto a = open_scan(folder / "plain.las"), b = open_scan(folder / "waves.las");
        ASSERT_TRUE(a && b) << b.error().line();
        EXPECT_EQ((*a)->schema(), (*b)->schema());
        EXPECT_EQ(testing::read_all(**a)->bytes, testing::read_all(**b)->bytes) << format;
        EXPECT_EQ((*b)->info().format, "LAS 1.4, point format " + std::to_string(format));
        EXPECT_EQ(notes_text((*b)->info().notes).find("100"), std::string::npos)
            << "the wave's description is kept";
    }
    LasFile small;
    small.minor = 4;
    small.format = 4;
    small.records = {std::string(56, '\0')};
    expect_rejected(small, "needs 57");
}

TEST_F(Las, CompressedFilesThatDoNotSayHowAreRejected) {
    LasFile file;
    file.records = {std::string(80, '\0')};
    file.minor = 4;
    file.format = 0x80 | 3;
    expect_rejected(file, "no LASzip record");
    file.format = 0;
    file.add_vlr("laszip encoded", 22204, "x");
    expect_rejected(file, "LASzip record that is cut off");
    file.vlrs.clear();
    file.format = 11;
    expect_rejected(file, "point format 11");
}

TEST_F(Las, HeadersThatLieAreRejectedWithTheLie) {
    LasFile good;
    good.records = {record0(1, 2, 3), record0(4, 5, 6)};
    const auto lie = [&](auto change, const std::string& reason) {
        LasFile file = good;
        change(file);
        expect_rejected(file, reason);
    };
    lie([](LasFile& f) { f.said_old_points = 3; }, "promises 3 points, 2 are there");
    lie([](LasFile& f) { f.said_old_points = 0xffffffff; }, "promises 4294967295 points, 2 are there");
    lie(
        [](LasFile& f) {
            f.minor = 4;
            f.said_points = std::numeric_limits<int64_t>::max();
        },
        "is truncated: its header promises");
    lie([](LasFile& f) { f.record_length = 19; }, "records of 19 bytes, but point format 0 needs 20");
    lie(
        [](LasFile& f) {
            f.record_length = 0;
            f.records = {""};
        },
        "records of 0 bytes");
    lie([](LasFile& f) { f.said_points_offset = 100; }, "inside the header");
    lie([](LasFile& f) { f.said_points_offset = 0xffffffff; }, "begin at byte 4294967295");
    lie([](LasFile& f) { f.said_header_size = 100; }, "header of 100 bytes");
    lie(
        [](LasFile& f) {
            f.minor = 4;
            f.said_header_size = 227;
        },
        "LAS 1.4 needs 375");
    lie([](LasFile& f) { f.major = 2; }, "LAS 2.2");
    lie([](LasFile& f) { f.minor = 9; }, "LAS 1.9");
    lie([](LasFile& f) { f.scale[2] = 0; }, "scale and offset for z");
    lie([](LasFile& f) { f.scale[0] = std::nan(""); }, "scale and offset for x");
    lie([](LasFile& f) { f.scale[1] = 1e-320; }, "scale and offset for y");
    lie([](LasFile& f) { f.scale[0] = 1e300; }, "scale and offset for x");
    lie([](LasFile& f) { f.offset[1] = std::numeric_limits<double>::infinity(); }, "scale and offset for y");
}

TEST_F(Las, RecordsThatAreNotThereHarmNoPoint) {
    LasFile file;
    file.minor = 4;
    file.records = {record0(1, 2, 3)};
    file.said_vlrs = 0xffffffff;
    file.said_evlrs = 0xffffffff;
    EXPECT_EQ(read_all(*open(file))->count, 1u);
    file.said_evlr_offset = 10;  // inside the header
    EXPECT_EQ(read_all(*open(file))->count, 1u);
    file.said_evlr_offset = std::numeric_limits<int64_t>::max();
    EXPECT_EQ(read_all(*open(file))->count, 1u);
    file.add_vlr("LASF_Projection", 2112, "wkt");
    put<uint16_t>(file.vlrs[0], 20, 60000);  // longer than the file
    EXPECT_EQ(read_all(*open(file))->count, 1u);
}

TEST_F(Las, WarningsAreOfTheFileTheyAreAbout) {
    LasFile file;
    file.records.assign(16, record0(1, 2, 3));
    const auto said = [&] {
        ::testing::internal::CaptureStderr();
        const auto source = open(file);
        for (int pass = 0; pass < 3; ++pass) EXPECT_TRUE(read_all(*source));
        return ::testing::internal::GetCapturedStderr();
    };
    EXPECT_EQ(said(), "");
    file.add_vlr("lascompatible", 22204, "");
    EXPECT_THAT(said(), HasSubstr("compatibility mode"));
    file.vlrs.clear();
    file.scale[1] = -0.01;
    EXPECT_THAT(
        said(),
        HasSubstr("its scale for y is negative (-0.01): the scan is mirrored unless this is intended"));
    const auto mirrored = open(file);
    EXPECT_EQ(position_of(mirrored->schema(), read_all(*mirrored)->bytes.data()).y, -0.02);
    file.scale[1] = 0.01;
    file.records[8] = record0(2'000'000'000, 2, 3);
    file.box = {0, 1};
    const std::string outside = said();
    EXPECT_THAT(outside, HasSubstr("far outside"));
    EXPECT_EQ(outside.find("far outside"), outside.rfind("far outside")) << "once, however often it is read";
}

TEST_F(Las, AnyTruncationIsRejected) {
    LasFile file;
    file.format = 3;
    file.add_vlr("LASF_Spec", 4, extra_descriptor(2, "extra"));
    file.records.assign(3, record0(1, 2, 3) + raw(0.5) + rgb(1, 2, 3) + "x");
    const std::string bytes = file.bytes();
    ASSERT_TRUE(open_bytes(bytes));
    for (size_t length = 0; length < bytes.size(); ++length) {
        const auto source = open_bytes(bytes.substr(0, length));
        ASSERT_FALSE(source) << length;
        EXPECT_EQ(source.error().kind, ErrorKind::input_rejected);
    }
}

std::string geo_keys(const std::vector<std::array<uint16_t, 4>>& keys) {
    std::string bytes =
        raw<uint16_t>(1) + raw<uint16_t>(1) + raw<uint16_t>(0) + raw(static_cast<uint16_t>(keys.size()));
    for (const auto& key : keys)
        for (const uint16_t number : key) bytes += raw(number);
    return bytes;
}

TEST_F(Las, UserIdsMayBePaddedWithBlanks) {
    LasFile file;
    file.add_vlr("LASF_Projection ", 34735, geo_keys({{1024, 0, 1, 1}, {3076, 0, 1, 9003}}));
    EXPECT_DOUBLE_EQ(open(file)->info().metres_per_unit, 1200.0 / 3937.0);
    if (shared_data().empty()) GTEST_SKIP() << "the shared data is not here";
    const auto reported = open_scan(shared_data() / "reports" / "uid_blank.las");
    ASSERT_TRUE(reported) << reported.error().line();
    EXPECT_DOUBLE_EQ((*reported)->info().metres_per_unit, 1200.0 / 3937.0);
}

TEST_F(Las, TheUnitComesFromGeoTiffKeys) {
    const std::map<uint16_t, double> units = {{9001, 1.0}, {9002, 0.3048}, {9003, 1200.0 / 3937.0}, {1, 1.0}};
    for (const auto& [code, metres] : units) {
        LasFile file;
        file.add_vlr("LASF_Projection", 34735, geo_keys({{1024, 0, 1, 1}, {3076, 0, 1, code}}));
        EXPECT_DOUBLE_EQ(open(file)->info().metres_per_unit, metres) << code;
    }
    LasFile own;
    own.add_vlr("LASF_Projection", 34735, geo_keys({{3076, 0, 1, 32767}, {3077, 34736, 1, 1}}));
    own.add_vlr("LASF_Projection", 34736, raw(7.0) + raw(0.25));
    EXPECT_EQ(open(own)->info().metres_per_unit, 0.25);
    LasFile lying;
    lying.add_vlr("LASF_Projection", 34735, geo_keys({{3076, 0, 1, 32767}, {3077, 34736, 1, 60000}}) + "odd");
    EXPECT_EQ(open(lying)->info().metres_per_unit, 1.0);
}

TEST_F(Las, TheUnitComesFromWellKnownText) {
    const std::map<std::string, double> texts = {
        {R"(PROJCS["a",GEOGCS["b",DATUM["d",SPHEROID["s",1,2]],UNIT["degree",0.0174532925199433]],PROJECTION["p"],UNIT["US survey foot",0.304800609601219]])",
         0.304800609601219},
        {R"(COMPD_CS["c",PROJCS["a",GEOGCS["b",UNIT["degree",0.01745]],UNIT["metre",1]],VERT_CS["v",UNIT["foot",0.3048]]])",
         1.0},
        {R"(PROJCRS["a",BASEGEOGCRS["b",DATUM["d",ELLIPSOID["e",1,2,LENGTHUNIT["metre",1]]]],CS[Cartesian,2],AXIS["e",east,LENGTHUNIT["foot",0.3048]]])",
         0.3048},
        {R"(LOCAL_CS["site, in [feet]",UNIT["foot",0.3048]])", 0.3048},
        {R"(GEOGCS["b",UNIT["degree",0.0174532925199433]])", 1.0},
        {R"(PROJCS["a",UNIT["broken",0]])", 1.0},
        {R"(PROJCS["a",UNIT["no end)", 1.0},
        {"]]]]PROJCS[[[UNIT[", 1.0},
        {std::string(100, '['), 1.0}};
    for (const auto& [text, metres] : texts) {
        LasFile file;
        file.encoding = 1 << 4;
        file.add_vlr("LASF_Projection", 2112, text);
        EXPECT_DOUBLE_EQ(open(file)->info().metres_per_unit, metres) << text;
    }
}

TEST_F(Las, ChangedBytesNeverCrashAndReadTheSameTwice) {
    LasFile file;
    file.minor = 4;
    file.format = 7;
    file.add_vlr("LASF_Spec", 4, extra_descriptor(5, "extra") + extra_descriptor(0, "more", 2));
    file.add_vlr("LASF_Projection", 34735, geo_keys({{3076, 0, 1, 9002}}));
    file.add_vlr("lucarne", 1, R"({"stations":[{"id":1,"position":[1,2,3]}]})", true);
    for (int i = 0; i < 20; ++i)
        file.records.push_back(record6(i, 2, 3, 4, 17, 0, 2, 0, 0, 1, 0.5) + rgb(1, 2, 3) + "123456");
    const std::string good = file.bytes();
    Random random(11);
    size_t opened = 0;
    for (int round = 0; round < 4000; ++round) {
        std::string bytes = good;
        for (uint64_t change = random.next() % 4 + 1; change-- > 0;) {
            // Mostly in the header and the records before the points, where false values matter.
            const size_t at = random.next() % (random.next() % 4 ? 900 : bytes.size());
            const uint64_t special[] = {0, 0xff, 0x7f, 0x80, 1, random.next()};
            bytes[at] = static_cast<char>(special[random.next() % 6]);
        }
        if (random.next() % 8 == 0) bytes.resize(random.next() % bytes.size());
        const auto source = open_bytes(bytes);
        if (!source) continue;
        ++opened;
        const auto first = read_all(**source), second = read_all(**source, 3);
        ASSERT_EQ(first.has_value(), second.has_value()) << round;
        if (!first) continue;
        ASSERT_TRUE(first->bytes == second->bytes) << round;
    }
    EXPECT_GT(opened, 100u);  // otherwise the loop tests nothing beyond the header
}

}  // namespace
}  // namespace lucarne::io
