// Every packing of E57 is read, and false values in a file do no harm.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "io/core/random.h"
#include "io/formats/e57/packets.h"
#include "tests/io/formats/e57/e57_builder.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using testing::BitStream;
using testing::BuiltFile;
using testing::BuiltScan;
using testing::data_packet;
using testing::float_field;
using ::testing::HasSubstr;
using testing::integer_field;
using testing::kXyzFields;
using testing::other_packet;
using testing::scaled_field;
using testing::xyz_packet;

class E57 : public ::testing::Test {
 protected:
    Result<testing::Records> read(const std::string& bytes, size_t batch = 3) {
        file_.set(bytes);
        LUCARNE_ASSIGN(source_, open_scan(file_.path()));
        return testing::read_all(*source_, batch);
    }
    Result<testing::Records> read(const BuiltFile& file) { return read(file.bytes()); }
    /// Expects that the file is refused on opening, before any point is read.
    void expect_refused(const std::string& bytes, const std::string& reason) {
        file_.set(bytes);
        const auto source = open_scan(file_.path());
        ASSERT_FALSE(source) << reason;
        EXPECT_EQ(source.error().kind, ErrorKind::input_rejected);
        EXPECT_THAT(source.error().line(), HasSubstr(reason));
    }
    void expect_refused(const BuiltFile& file, const std::string& reason) {
        expect_refused(file.bytes(), reason);
    }
    /// Expects that the file opens and fails while it is read.
    void expect_unreadable(const BuiltFile& file, const std::string& reason) {
        const auto records = read(file);
        ASSERT_FALSE(records) << reason;
        EXPECT_EQ(records.error().kind, ErrorKind::input_rejected);
        EXPECT_THAT(records.error().line(), HasSubstr(reason));
    }
    glm::dvec3 position(const testing::Records& r, size_t i) const {
        return position_of(source_->schema(), &r.bytes[i * source_->schema().stride]);
    }
    double value(const testing::Records& r, size_t i, std::string_view name, size_t component = 0) const {
        const Attribute* a = source_->schema().find(name);
        if (!a) {
            ADD_FAILURE() << "no " << name;
            return std::nan("");
        }
        return scalar_at(
            a->type, &r.bytes[i * source_->schema().stride + a->offset + component * scalar_bytes(a->type)]);
    }
    const testing::MemoryFile file_;
    std::unique_ptr<PointSource> source_;
};

BuiltScan one_point(const std::string& more_fields = {}, const std::vector<std::string>& more_streams = {}) {
    return {kXyzFields + more_fields, 1, xyz_packet({{1, 2, 3}}, more_streams)};
}

std::string stream_of(unsigned bits, const std::vector<uint64_t>& values) {
    BitStream stream{bits};
    for (const uint64_t v : values) stream.add(v);
    return stream.bytes;
}

TEST(E57Checksum, IsTheSameByInstructionAndByTable) {
    const std::string check = "123456789";  // the check value of CRC-32C (Koopman 2002)
    EXPECT_EQ(e57::crc32c(std::as_bytes(std::span(check))), 0xe3069283u);
    Random random(3);
    std::string bytes;
    for (size_t length = 0; length < 100; ++length, bytes += static_cast<char>(random.next()))
        EXPECT_EQ(e57::crc32c(std::as_bytes(std::span(bytes))),
                  e57::crc32c_by_table(std::as_bytes(std::span(bytes))));
}

TEST_F(E57, IntegersOfEveryWidthAreUnpackedAcrossPackets) {
    Random random(7);
    for (unsigned bits = 0; bits <= 64; ++bits) {
        const uint64_t mask = bits == 0 ? 0 : ~uint64_t{0} >> (64 - bits);
        const int64_t minimum = bits == 64 ? std::numeric_limits<int64_t>::min() : bits == 63 ? -5 : -1000;
        BitStream stream{bits};
        std::vector<std::array<double, 3>> points;
        std::vector<int64_t> expected;
        for (size_t i = 0; i < 1500; ++i) {
            const uint64_t raw = i == 0 ? mask : random.next() & mask;
            stream.add(raw);
            expected.push_back(static_cast<int64_t>(static_cast<uint64_t>(minimum) + raw));
            points.push_back({static_cast<double>(i), 0, 0});
        }
        // The coordinates are in three packets, the integers in three others that cut values anywhere.
        BuiltScan scan;
        const auto maximum = static_cast<int64_t>(static_cast<uint64_t>(minimum) + mask);
        scan.prototype = kXyzFields + integer_field("v", minimum, maximum);
        scan.records = points.size();
        for (size_t part = 0; part < 3; ++part) {
            const size_t bytes = stream.bytes.size();
            scan.packets += data_packet(
                {"", "", "",
                 stream.bytes.substr(bytes * part / 3, bytes * (part + 1) / 3 - bytes * part / 3)});
            scan.packets += xyz_packet({points.begin() + static_cast<long>(500 * part),
                                        points.begin() + static_cast<long>(500 * (part + 1))},
                                       {""});
            scan.packets += other_packet(part % 2 == 0 ? '\0' : '\2', 20);
        }
        const auto r = read(BuiltFile{{scan}}.bytes(), 400);
        ASSERT_TRUE(r) << bits << r.error().line();
        ASSERT_EQ(r->count, expected.size());
        const Attribute* a = source_->schema().find("v");
        for (size_t i = 0; i < expected.size(); ++i) {
            const std::byte* at = &r->bytes[i * source_->schema().stride + a->offset];
            const int64_t got =
                a->type == ScalarType::i64 ? load<int64_t>(at) : static_cast<int64_t>(scalar_at(a->type, at));
            ASSERT_EQ(got, expected[i]) << bits << " bits, value " << i;
        }
    }
}

TEST_F(E57, IntegersGetTheSmallestTypeThatHoldsTheirBits) {
    struct Case {
        int64_t minimum, maximum;
        ScalarType type;
    };
    const auto most = std::numeric_limits<int64_t>::max(), least = std::numeric_limits<int64_t>::min();
    for (const Case& c : {Case{0, 200, ScalarType::u8},
                          {0, 256, ScalarType::u16},
                          {-100, 100, ScalarType::i16},
                          {-128, 127, ScalarType::i8},
                          {0, 70000, ScalarType::u32},
                          {-1, 70000, ScalarType::i32},
                          {0, most, ScalarType::i64},
                          {least, most, ScalarType::i64},
                          {7, 7, ScalarType::u8}}) {
        const auto r =
            read(BuiltFile{{one_point(integer_field("v", c.minimum, c.maximum), {std::string(8, '\0')})}});
        ASSERT_TRUE(r) << r.error().line();
        EXPECT_EQ(source_->schema().find("v")->type, c.type) << c.minimum << ' ' << c.maximum;
        EXPECT_EQ(value(*r, 0, "v"), static_cast<double>(c.minimum));
    }
}

TEST_F(E57, PositionsStayAsTheFileHasThem) {
    BitStream f{32}, g{32}, h{32};
    f.add(0.1f), g.add(-2.5f), h.add(3e20f);
    BuiltScan floats{float_field("cartesianX", "single") + float_field("cartesianY", "single") +
                         float_field("cartesianZ", "single"),
                     1, data_packet({f.bytes, g.bytes, h.bytes})};
    auto r = read(BuiltFile{{floats}});
    ASSERT_TRUE(r) << r.error().line();
    EXPECT_EQ(source_->schema().position, PositionType::f32);
    EXPECT_EQ(position(*r, 0), glm::dvec3(0.1f, -2.5f, 3e20f));

    BuiltScan scaled{scaled_field("cartesianX", -100, 1000000, "0.001", "600000") +
                         scaled_field("cartesianY", 0, 7, "0.5") + integer_field("cartesianZ", -4, 3),
                     2,
                     data_packet({stream_of(20, {0, 1000100}), stream_of(3, {7, 0}), stream_of(3, {0, 7})})};
    r = read(BuiltFile{{scaled}});
    ASSERT_TRUE(r) << r.error().line();
    EXPECT_EQ(source_->schema().position, PositionType::i32_scaled);
    EXPECT_EQ(position(*r, 0), glm::dvec3(-100 * 0.001 + 600000, 3.5, -4));
    EXPECT_EQ(position(*r, 1), glm::dvec3(1000000 * 0.001 + 600000, 0, 3));

    BuiltScan wide{scaled_field("cartesianX", 0, int64_t{1} << 40, "1e-6") + float_field("cartesianY") +
                       float_field("cartesianZ"),
                   1,
                   data_packet({stream_of(41, {uint64_t{1} << 40}), stream_of(64, {0}), stream_of(64, {0})})};
    r = read(BuiltFile{{wide}});
    ASSERT_TRUE(r) << r.error().line();
    EXPECT_EQ(source_->schema().position, PositionType::f64);
    EXPECT_EQ(position(*r, 0).x, 0x1p40 * 1e-6);
}

const std::string kQuarterTurn =  // about z: x becomes y
    "<pose "
    "type=\"Structure\"><rotation><w>0.70710678118654757</w><x/><y/><z>0.70710678118654757</z></rotation>"
    "<translation><x>10</x><y>20.5</y><z>-3</z></translation></pose>";

TEST_F(E57, PosesTurnAndMovePointsAndNormalsAndBecomeStations) {
    BuiltScan posed =
        one_point(float_field("nor:normalX") + float_field("nor:normalY") + float_field("nor:normalZ"),
                  {stream_of(64, {0x3ff0000000000000}), stream_of(64, {0}), stream_of(64, {0})});
    posed.more = kQuarterTurn;
    const auto r = read(BuiltFile{{one_point(), posed}});
    ASSERT_TRUE(r) << r.error().line();
    ASSERT_EQ(r->count, 2u);
    EXPECT_EQ(position(*r, 0), glm::dvec3(1, 2, 3));
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(position(*r, 1)[axis], glm::dvec3(8, 21.5, 0)[axis], 1e-14);
    EXPECT_NEAR(value(*r, 1, names::normal, 0), 0, 1e-15);
    EXPECT_NEAR(value(*r, 1, names::normal, 1), 1, 1e-15);
    EXPECT_EQ(value(*r, 0, names::normal, 1), 0) << "a scan without normals has none";
    ASSERT_EQ(source_->info().stations.size(), 1u);
    EXPECT_EQ(source_->info().stations[0].position, glm::dvec3(10, 20.5, -3));
    EXPECT_EQ(source_->info().stations[0].id, 2u);
    EXPECT_EQ(value(*r, 0, names::point_source_id), 1);
    EXPECT_EQ(value(*r, 1, names::point_source_id), 2);
}

TEST_F(E57, SphericalCoordinatesCountFromTheScanner) {
    const double half_pi = std::acos(0.0);
    BitStream range, azimuth, elevation;
    for (const double v : {2.0, 2.0, 2.0}) range.add(v);
    for (const double v : {0.0, half_pi, 1.0}) azimuth.add(v);
    for (const double v : {0.0, 0.0, half_pi}) elevation.add(v);
    BuiltScan scan{
        float_field("sphericalRange") + float_field("sphericalAzimuth") + float_field("sphericalElevation"),
        3, data_packet({range.bytes, azimuth.bytes, elevation.bytes})};
    const auto r = read(BuiltFile{{scan}});
    ASSERT_TRUE(r) << r.error().line();
    const std::array<glm::dvec3, 3> expected = {{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}};
    for (size_t i = 0; i < 3; ++i)
        for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(position(*r, i)[axis], expected[i][axis], 1e-15);
    ASSERT_EQ(source_->info().stations.size(), 1u);
    EXPECT_EQ(source_->info().stations[0].position, glm::dvec3(0));
}

TEST_F(E57, InvalidAndNonFinitePointsAreDroppedAndCounted) {
    const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
    BuiltScan scan{kXyzFields + integer_field("cartesianInvalidState", 0, 2), 6,
                   xyz_packet({{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {nan, 0, 0}, {5, -infinite, 0}, {6, 0, 0}},
                              {stream_of(2, {0, 1, 2, 0, 0, 0})})};
    const auto r = read(BuiltFile{{scan}});
    ASSERT_TRUE(r) << r.error().line();
    ASSERT_EQ(r->count, 2u);
    EXPECT_EQ(r->dropped, 4u);
    EXPECT_EQ(position(*r, 1).x, 6);
    EXPECT_TRUE(source_->schema().attributes.empty());
}

std::string color_fields(int64_t most) {
    return integer_field("colorRed", 0, most) + integer_field("colorGreen", 0, most) +
           integer_field("colorBlue", 0, most);
}
std::string limits(double most) {
    return fmt::format(
        "<colorLimits><colorRedMaximum>{0}</colorRedMaximum><colorGreenMaximum>{0}</colorGreenMaximum>"
        "<colorBlueMaximum>{0}</colorBlueMaximum></colorLimits>",
        most);
}

TEST_F(E57, ColoursAreKeptAsTheyAreUnlessTheirWhiteIsOdd) {
    struct Case {
        int64_t most;
        double limit;  // 0 means none
        ScalarType type;
        uint32_t bits;
        double half;
    };
    for (const Case& c : {Case{255, 0, ScalarType::u8, 8, 127},
                          {255, 255, ScalarType::u8, 8, 127},
                          {255, 240, ScalarType::u8, 8, 127},
                          {65535, 0, ScalarType::u16, 16, 32767},
                          {65535, 255, ScalarType::u16, 8, 32767},
                          {1023, 1023, ScalarType::u16, 16, std::round(511 * 65535.0 / 1023)}}) {
        const unsigned bits = c.most == 255 ? 8 : c.most == 1023 ? 10 : 16;
        const std::string half = stream_of(bits, {static_cast<uint64_t>(c.most / 2)});
        BuiltScan scan = one_point(color_fields(c.most), {half, half, half});
        if (c.limit > 0) scan.more = limits(c.limit);
        const auto r = read(BuiltFile{{scan}});
        ASSERT_TRUE(r) << r.error().line();
        EXPECT_EQ(source_->schema().find(names::color)->type, c.type) << c.most;
        EXPECT_EQ(source_->info().color_bits, c.bits) << c.most << ' ' << c.limit;
        EXPECT_EQ(value(*r, 0, names::color, 1), c.half);
    }
}

TEST_F(E57, ScansWithDifferentFieldsBecomeOneSchemaWithDefinedGaps) {
    const std::string white = stream_of(8, {255}), half = stream_of(16, {32768});
    BuiltScan eight = one_point(color_fields(255) + integer_field("rowIndex", 0, 9),
                                {white, white, white, stream_of(4, {7})});
    BuiltScan sixteen = one_point(
        color_fields(65535) + float_field("intensity", "single") + integer_field("rowIndex", -9, 300),
        {half, half, half, stream_of(32, {0x3f000000}), stream_of(9, {309})});
    const auto r = read(BuiltFile{{eight, one_point(), sixteen}});
    ASSERT_TRUE(r) << r.error().line();
    ASSERT_EQ(r->count, 3u);
    EXPECT_EQ(source_->schema().find(names::color)->type, ScalarType::u16);
    EXPECT_EQ(source_->info().color_bits, 16u);
    EXPECT_EQ(value(*r, 0, names::color), 65535);
    EXPECT_EQ(value(*r, 1, names::color), std::round(.735 * 65535)) << "an albedo of .5";
    EXPECT_EQ(value(*r, 2, names::color), 32768);
    EXPECT_EQ(value(*r, 0, names::intensity), 0);
    EXPECT_EQ(value(*r, 2, names::intensity), 0.5);
    EXPECT_EQ(source_->schema().find("rowIndex")->type, ScalarType::i16);
    EXPECT_EQ(value(*r, 0, "rowIndex"), 7);
    EXPECT_EQ(value(*r, 2, "rowIndex"), 300);
}

TEST_F(E57, ColoursThatAreMarkedInvalidLookLikeNone) {
    const std::string red = stream_of(8, {255, 255}), none = stream_of(8, {0, 0});
    BuiltScan scan{kXyzFields + color_fields(255) + integer_field("isColorInvalid", 0, 1), 2,
                   xyz_packet({{1, 2, 3}, {4, 5, 6}}, {red, none, none, stream_of(1, {0, 1})})};
    const auto r = read(BuiltFile{{scan}});
    ASSERT_TRUE(r) << r.error().line();
    EXPECT_EQ(value(*r, 0, names::color, 1), 0);
    EXPECT_EQ(value(*r, 1, names::color, 1), 187);
    EXPECT_EQ(value(*r, 1, "isColorInvalid"), 1);
}

TEST_F(E57, ScaledIntegersKeepTheirSteps) {
    const auto type_of = [&](int64_t most, const std::string& scale, const std::string& offset) {
        const auto r = read(BuiltFile{
            {one_point(scaled_field("timeStamp", 0, most, scale, offset), {std::string(8, '\0')})}});
        EXPECT_TRUE(r) << r.error().line();
        return source_->schema().find("timeStamp")->type;
    };
    EXPECT_EQ(type_of(32767, "3e-5", "0"), ScalarType::f32);
    EXPECT_EQ(type_of(32767, "3e-5", "1e6"), ScalarType::f64);
    EXPECT_EQ(type_of(int64_t{1} << 30, "1e-3", "0"), ScalarType::f64);
}

TEST_F(E57, TextFieldsAndUnknownOnesHarmNothing) {
    const auto r =
        read(BuiltFile{{one_point("<ext:label type=\"String\"/>" + integer_field("ext:class", 0, 255),
                                  {"\6\0abc", stream_of(8, {9})})}});
    ASSERT_TRUE(r) << r.error().line();
    EXPECT_EQ(value(*r, 0, "ext:class"), 9);
    EXPECT_EQ(source_->schema().attributes.size(), 1u);
}

TEST_F(E57, ImagesAreListedAndNotRead) {
    BuiltFile file{{one_point()}};
    file.images =
        "<vectorChild><name>front</name><sphericalRepresentation><jpegImage type=\"Blob\" "
        "fileOffset=\"99999999\" length=\"1504576\"/>"
        "<imageHeight>2304</imageHeight><imageWidth>3072</imageWidth></sphericalRepresentation></"
        "vectorChild>";
    const auto r = read(file);
    ASSERT_TRUE(r) << r.error().line();
    const E57Notes& notes = *source_->info().notes.e57;
    EXPECT_TRUE(notes.images.at(0) == (E57Notes::Image{"front", "spherical", "jpeg", 1504576, 3072, 2304}));
    EXPECT_EQ(notes.scans.at(0).name, "a <scan>");
}

TEST_F(E57, AFileWithoutPointsIsEmpty) {
    BuiltScan none = one_point();
    none.records = 0;
    none.spoil = [](std::string& section) { section[0] = '\x55'; };  // some writers leave it unwritten
    for (const BuiltFile& file : {BuiltFile{}, BuiltFile{{none}}}) {
        const auto r = read(file);
        ASSERT_TRUE(r) << r.error().line();
        EXPECT_EQ(r->count, 0u);
    }
}

TEST_F(E57, EveryChangedByteOfAPageIsFound) {
    const std::string good = BuiltFile{{one_point()}}.bytes();
    ASSERT_TRUE(read(good));
    for (size_t at = 0; at < good.size(); at += 7) {
        std::string bytes = good;
        bytes[at] = static_cast<char>(bytes[at] ^ 4);
        EXPECT_FALSE(read(bytes)) << at;
    }
    for (size_t length = 0; length < good.size(); length += 13)
        EXPECT_FALSE(read(good.substr(0, length))) << length;
}

TEST_F(E57, CountsAndOffsetsThatLieAreRefusedBeforeReading) {
    const auto scan_with = [&](const std::function<void(BuiltScan&)>& change) {
        BuiltScan scan = one_point();
        change(scan);
        return BuiltFile{{scan}};
    };
    for (const char* count : {"-1", "1e3", "99999999999999999999", "", "x"})
        expect_refused(scan_with([&](BuiltScan& s) { s.record_count = *count ? count : " "; }), "count");
    expect_refused(scan_with([](BuiltScan& s) { s.record_count = "1099511627776"; }),
                   "promises 1099511627776 points, at most");
    for (const char* offset : {"0", "47"})
        expect_refused(scan_with([&](BuiltScan& s) { s.file_offset = offset; }), "inside its header");
    expect_refused(scan_with([](BuiltScan& s) { s.file_offset = "1020"; }), "inside a checksum");
    expect_refused(scan_with([](BuiltScan& s) { s.file_offset = "18446744073709551614"; }), "beyond its end");
    expect_refused(scan_with([](BuiltScan& s) { s.file_offset = "60"; }), "is not one");
    expect_refused(scan_with([](BuiltScan& s) { s.spoil = [](std::string& b) { b[15] = '\x7f'; }; }),
                   "reaches beyond its end");
    expect_refused(scan_with([](BuiltScan& s) { s.spoil = [](std::string& b) { b[8] = 16; }; }),
                   "reaches beyond its end");
    expect_refused(scan_with([](BuiltScan& s) { s.spoil = [](std::string& b) { b[16] = 48; }; }),
                   "has its packets elsewhere");
    // Constant columns take no bits at all: reading 2^40 of them would take hours.
    BuiltScan constant{integer_field("cartesianX", 1, 1) + integer_field("cartesianY", 2, 2) +
                           integer_field("cartesianZ", 3, 3),
                       5, data_packet({"", "", ""})};
    const auto r = read(BuiltFile{{constant}});
    ASSERT_TRUE(r) << r.error().line();
    EXPECT_EQ(position(*r, 4), glm::dvec3(1, 2, 3));
    constant.records = uint64_t{1} << 40;
    expect_refused(BuiltFile{{constant}}, "promises 1099511627776 points");
}

TEST_F(E57, ManyScansOfConstantsHoldNoMorePointsThanOne) {
    BuiltScan constant{integer_field("cartesianX", 1, 1) + integer_field("cartesianY", 2, 2) +
                           integer_field("cartesianZ", 3, 3),
                       65000, data_packet({"", "", ""})};
    BuiltFile file{{constant, constant}};
    expect_refused(file, "promises 130000 points that take no bytes, at most 65536");
    file.scans[1].records = 536;
    const auto r = read(file);
    ASSERT_TRUE(r) << r.error().line();
    EXPECT_EQ(r->count, 65536u);
    // A larger file may have as many such points as it has bytes.
    file.scans[1].records = 65000;
    std::string bytes(size_t{1} << 14, '\0');
    file.scans.push_back({integer_field("cartesianX", 0, 255) + integer_field("cartesianY", 0, 255) +
                              integer_field("cartesianZ", 0, 255),
                          16 * bytes.size(), ""});
    for (int packet = 0; packet < 16; ++packet) file.scans[2].packets += data_packet({bytes, bytes, bytes});
    EXPECT_TRUE(read(file));
    // Salvaging leaves out the scans beyond the limit.
    file.scans.pop_back();
    file_.set(file.bytes());
    const auto saved = open_scan(file_.path(), {.salvage = true});
    ASSERT_TRUE(saved) << saved.error().line();
    EXPECT_EQ(testing::read_all(**saved, 1000)->count, 65000u);
}

TEST_F(E57, APoseWhoseQuaternionIsZeroOnlyMoves) {
    BuiltScan posed = one_point();
    posed.more = "<pose><rotation><w>0</w><x>0</x></rotation><translation><x>10</x></translation></pose>";
    const auto r = read(BuiltFile{{posed, one_point()}});
    ASSERT_TRUE(r) << r.error().line();
    ASSERT_EQ(r->count, 2u);
    EXPECT_EQ(position(*r, 0), glm::dvec3(11, 2, 3));
    EXPECT_EQ(position(*r, 1), glm::dvec3(1, 2, 3));
}

TEST_F(E57, TheStatedBoxIsThatOfAllScansThatAreMovedAndNotTurned) {
    const auto stating = [](double at, const std::string& pose) {
        BuiltScan scan = one_point();
        scan.more = pose + "<cartesianBounds>";
        for (const char axis : {'x', 'y', 'z'})
            scan.more +=
                fmt::format("<{0}Minimum>{1}</{0}Minimum><{0}Maximum>{2}</{0}Maximum>", axis, at, at + 2);
        scan.more += "</cartesianBounds>";
        return scan;
    };
    const std::string moved = "<pose><translation><x>10</x></translation></pose>";
    BuiltScan empty{kXyzFields, 0, {}};
    using Box = std::array<glm::dvec3, 2>;
    ASSERT_TRUE(read(BuiltFile{{stating(1, ""), empty, stating(-4, moved)}}));
    EXPECT_EQ(source_->info().stated_box, (Box{glm::dvec3(1, -4, -4), glm::dvec3(8, 3, 3)}));
    for (const BuiltScan& other :
         {one_point(), stating(0, kQuarterTurn), stating(-INFINITY, ""), stating(NAN, "")}) {
        ASSERT_TRUE(read(BuiltFile{{stating(1, ""), other}}));
        EXPECT_FALSE(source_->info().stated_box) << other.more;
    }
}

TEST_F(E57, SectionsThatOverlapAreRefused) {
    BuiltScan again = one_point();
    again.file_offset = std::to_string(e57::kHeaderBytes);
    expect_refused(BuiltFile{{one_point(), again}}, "overlap");
    BuiltScan over_xml = one_point();
    over_xml.spoil = [](std::string& section) { section[9] = 1; };  // 256 bytes more
    expect_refused(BuiltFile{{over_xml}}, "overlap");
}

TEST_F(E57, FieldsWithoutSenseAreRefusedByName) {
    const auto with = [](const std::string& field) {
        return BuiltFile{{one_point(field, {std::string(8, '\0')})}};
    };
    expect_refused(with(scaled_field("v", 0, 7, "nan")), "scale of v");
    expect_refused(with(scaled_field("v", 0, 7, "inf")), "scale of v");
    expect_refused(with(scaled_field("v", 0, 7, "0")), "a scale of 0");
    expect_refused(with(scaled_field("v", 0, 7, "1e99")), "a scale of 1e+99");
    expect_refused(with(scaled_field("v", 0, 7, "1", "nan")), "offset of v");
    expect_refused(with(integer_field("v", 8, 7)), "a minimum above its maximum");
    expect_refused(with("<v type=\"Integer\" minimum=\"9223372036854775808\"/>"), "minimum of v");
    expect_refused(with("<v type=\"Float\" precision=\"half\"/>"), "unknown precision");
    expect_refused(with("<v type=\"Structure\"/>"), "the type 'Structure'");
    std::string many;
    for (int i = 0; i < 300; ++i) many += float_field(fmt::format("f{}", i));
    expect_refused(with(many), "more than 256 fields");
    BuiltScan flat{float_field("cartesianX") + float_field("cartesianY"), 1,
                   data_packet({"01234567", "01234567"})};
    expect_refused(BuiltFile{{flat}}, "no coordinates");
    for (const char* pose : {"<rotation><w>nan</w></rotation>", "<translation><x>1e99</x></translation>",
                             "<translation><x>far</x></translation>"}) {
        BuiltScan posed = one_point();
        posed.more = std::string("<pose>") + pose + "</pose>";
        expect_refused(BuiltFile{{posed}}, "has ");
    }
}

TEST_F(E57, XmlThatWouldExplodeOrMakesNoSenseIsRefused) {
    BuiltFile file{{one_point()}};
    file.header_xml = "<!DOCTYPE a [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\">]>";
    EXPECT_TRUE(read(file)) << "never expanded";
    file.xml = "<e57Root";
    expect_refused(file, "not well-formed");
    file.xml = "<root/>";
    expect_refused(file, "without e57Root");
    file.xml = "<e57Root><data3D><vectorChild/></data3D></e57Root>";
    expect_refused(file, "without points");
    file.xml = "<e57Root>";
    for (size_t i = 0; i <= e57::kMostTags; ++i) file.xml += "<a/>";
    expect_refused(file, "tags");
    file.xml = std::string(e57::kMostXmlBytes + 1, ' ');
    expect_refused(file, "32 MiB");
}

TEST_F(E57, DeepXmlDoesNotExhaustTheStack) {
    BuiltFile file;
    for (int i = 0; i < 400000; ++i) file.xml += "<a>";
    expect_refused(file, "not well-formed");
    std::string end;
    for (int i = 0; i < 400000; ++i) end += "</a>";
    file.xml = "<e57Root>" + file.xml + end + "</e57Root>";
    EXPECT_TRUE(read(file));
}

TEST_F(E57, DamagedPacketsEndTheReading) {
    const auto spoilt = [](size_t at, char byte) {
        BuiltScan scan = one_point();
        scan.packets[at] = byte;
        return BuiltFile{{scan}};
    };
    expect_unreadable(spoilt(0, 7), "damaged packet");
    expect_unreadable(spoilt(2, 1), "damaged packet");  // two bytes long
    expect_unreadable(spoilt(3, 1), "ends early");      // longer than the section
    expect_unreadable(spoilt(4, 2), "2 streams where points have 3 fields");
    expect_unreadable(spoilt(6, 99), "longer than itself");
    BuiltScan missing = one_point();
    missing.packets += other_packet('\2', 400);
    missing.records = 3;
    expect_unreadable(BuiltFile{{missing}}, "2 points of a scan are missing");
}

TEST_F(E57, HeadersWithoutSenseAreRefused) {
    const std::string good = BuiltFile{{one_point()}}.logical();
    const auto with = [&](size_t at, uint64_t number) {
        std::string logical = good;
        std::memcpy(&logical[at], &number, sizeof number);
        return testing::with_checksums(logical);
    };
    expect_refused(with(8, 2), "is E57 2.0");
    expect_refused(with(40, 4096), "pages of 4096 bytes");
    expect_refused(with(16, uint64_t{1} << 60), "is truncated");
    expect_refused(with(16, 1000), "no whole pages");
    expect_refused(with(24, uint64_t{1} << 60), "the XML section at");
    expect_refused(with(32, uint64_t{1} << 60), "reaches beyond its end");
    expect_refused("ASTM-E57", "ends");
}

TEST_F(E57, ChangedBytesNeverCrashAndReadTheSameTwice) {
    BuiltScan posed = one_point(color_fields(255) + scaled_field("intensity", 0, 1000, "0.001") +
                                    integer_field("cartesianInvalidState", 0, 2),
                                {"a", "b", "c", "de", std::string(1, '\0')});
    posed.more = kQuarterTurn + limits(255);
    const std::string good = BuiltFile{{posed, one_point(integer_field("rowIndex", -7, 7), {"x"})}}.logical();
    Random random(57);
    size_t opened = 0;
    for (int round = 0; round < 6000; ++round) {
        std::string logical = good;
        for (uint64_t change = random.next() % 3 + 1; change-- > 0;) {
            const char special[] = {'\0', '\xff', '9', '-', ' ', '"', static_cast<char>(random.next())};
            logical[16 + random.next() % (logical.size() - 16)] = special[random.next() % sizeof special];
        }
        const auto first = read(testing::with_checksums(logical));
        if (!source_) continue;
        const auto second = testing::read_all(*source_, 1);
        opened += first.has_value();
        ASSERT_EQ(first.has_value(), second.has_value());
        if (first) {
            ASSERT_TRUE(first->bytes == second->bytes);
        }
        source_.reset();
    }
    EXPECT_GT(opened, 500u);
}

}  // namespace
}  // namespace lucarne::io
