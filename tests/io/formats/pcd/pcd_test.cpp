// PCD in all encodings gives the same points; contradictory files are rejected; written files are read back.
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "io/core/random.h"
#include "tests/io/formats/scan_text.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;

class Pcd : public testing::TextScan {};

std::string header(const std::string& fields, const std::string& sizes, const std::string& types,
                   const std::string& counts, const std::string& rest) {
    return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + sizes +
           "\nTYPE " + types + "\nCOUNT " + counts + "\n" + rest;
}
std::string grid(int width, int height, const std::string& data) {
    return fmt::format("WIDTH {}\nHEIGHT {}\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS {}\nDATA {}\n", width, height,
                       width * height, data);
}
const std::string kFields = header("x rgb y z _ normal_x normal_y normal_z label pair", "4 4 4 4 1 4 4 4 2 1",
                                   "F F F F U F F F I U", "1 1 1 1 3 1 1 1 1 2", "");

template <class T>
void put(std::string& text, T value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Returns the fields of kFields, point by point.
std::vector<std::vector<std::string>> fields_of_points() {
    std::vector<std::vector<std::string>> points;
    for (int i = 0; i < 4; ++i) {
        std::vector<std::string> fields(10);
        put(fields[0], i == 2 ? NAN : 1.5f + static_cast<float>(i));
        put(fields[1], uint32_t{0x00102030} + static_cast<uint32_t>(i));
        put(fields[2], -2.5f);
        put(fields[3], 3.25f);
        fields[4] = "abc";
        put(fields[5], 0.f);
        put(fields[6], 0.f);
        put(fields[7], 1.f);
        put(fields[8], static_cast<int16_t>(-i));
        put(fields[9], static_cast<uint16_t>(0x0102 + i));
        points.push_back(fields);
    }
    return points;
}

/// Returns LZF with literal bytes only.
std::string stored(const std::string& bytes) {
    std::string packed;
    for (size_t at = 0; at < bytes.size(); at += 32) {
        const size_t count = std::min<size_t>(32, bytes.size() - at);
        packed += static_cast<char>(count - 1);
        packed += bytes.substr(at, count);
    }
    return packed;
}
std::string compressed(const std::string& packed, size_t unpacked) {
    std::string text;
    put(text, static_cast<uint32_t>(packed.size()));
    put(text, static_cast<uint32_t>(unpacked));
    return text + packed;
}
std::string by_field() {
    std::string bytes;
    for (size_t f = 0; f < 10; ++f)
        for (const auto& point : fields_of_points()) bytes += point[f];
    return bytes;
}
std::string by_point() {
    std::string bytes;
    for (const auto& point : fields_of_points())
        for (const auto& field : point) bytes += field;
    return bytes;
}
std::string ascii() {
    float rgb[4];
    std::string text;
    for (uint32_t i = 0; i < 4; ++i) {
        const uint32_t bits = 0x00102030 + i;
        std::memcpy(&rgb[i], &bits, 4);
        text += fmt::format("{} {} -2.5 3.25 97 98 99 0 0 1 {} {} 1\n",
                            i == 2 ? "nan" : fmt::format("{}.5", i + 1), rgb[i], -static_cast<int>(i), 2 + i);
    }
    return text;
}

TEST_F(Pcd, TheCaseOfFieldsAndEntriesDoesNotMatter) {
    const std::string rows = "1 2 3 255 0.5\n4 5 6 65280 0.25\n";
    for (const std::string& file :
         {"VERSION 0.7\nFIELDS X Y Z RGB Intensity\nSIZE 4 4 4 4 4\nTYPE F F F U F\nCOUNT 1 1 1 1 1\n" +
              grid(2, 1, "ASCII") + rows,
          "version 0.7\nfields x y z rgb intensity\nsize 4 4 4 4 4\ntype f f f u f\ncount 1 1 1 1 1\nwidth "
          "2\n"
          "height 1\nviewpoint 0 0 0 1 0 0 0\npoints 2\ndata ascii\n" +
              rows}) {
        read(file);
        ASSERT_EQ(points(), 2u) << file;
        EXPECT_EQ(position(1), glm::dvec3(4, 5, 6));
        EXPECT_EQ(value(0, names::color, 2), 255);
        EXPECT_EQ(value(1, names::intensity), .25);
    }
    read("FIELDS X x y z\nSIZE 4 4 4 4\nTYPE F F F F\n" + grid(1, 1, "ascii") + "9 1 2 3\n");
    EXPECT_EQ(position(0), glm::dvec3(1, 2, 3)) << "x goes before X";
    EXPECT_EQ(value(0, "X"), 9);
    EXPECT_THAT(
        error_of("FIELDS X X Y Z\nSIZE 4 4 4 4\nTYPE F F F F\n" + grid(1, 1, "ascii") + "9 1 2 3\n").line(),
        HasSubstr("does not have one field x"));
}

TEST_F(Pcd, AllEncodingsGiveTheSamePoints) {
    read(kFields + grid(2, 2, "ascii") + ascii());
    ASSERT_EQ(points(), 3u);
    EXPECT_EQ(records_.dropped, 1u);
    EXPECT_EQ(schema().position, PositionType::f32);
    EXPECT_EQ(position(2), glm::dvec3(4.5, -2.5, 3.25));
    EXPECT_EQ(value(0, names::color, 0), 0x10);
    EXPECT_EQ(value(2, names::color, 2), 0x33);
    EXPECT_EQ(value(0, names::normal, 2), 1);
    EXPECT_EQ(value(1, "label"), -1);
    EXPECT_EQ(value(2, "pair_0"), 5);
    EXPECT_EQ(value(2, "pair_1"), 1);
    EXPECT_EQ(schema().attributes.size(), 5u);  // no padding
    ASSERT_EQ(source_->info().stations.size(), 1u);
    EXPECT_EQ(source_->info().stations[0].position, glm::dvec3(1, 2, 3));
    const auto text = records_.bytes;
    read(kFields + grid(2, 2, "binary") + by_point());
    EXPECT_TRUE(records_.bytes == text);
    EXPECT_EQ(records_.dropped, 1u);
    read(kFields + grid(2, 2, "binary_compressed") + compressed(stored(by_field()), by_field().size()));
    EXPECT_TRUE(records_.bytes == text);
    EXPECT_EQ(records_.dropped, 1u);
}

TEST_F(Pcd, RepeatsOfLzfAreFollowed) {
    const std::string fields = header("x y z", "4 4 4", "F F F", "1 1 1", "");
    // 4 literal bytes; then copies of 8 bytes and of 24 bytes from 4 bytes back, which overlap their own
    // output.
    std::string packed("\x03\0\0\x80\x3f", 5);
    packed += std::string("\xc0\x03", 2);      // 6 + 2 from 4 back
    packed += std::string("\xe0\x0f\x03", 3);  // 7 + 15 + 2 from 4 back
    read(fields + grid(3, 1, "binary_compressed") + compressed(packed, 36));
    ASSERT_EQ(points(), 3u);
    for (size_t i = 0; i < 3; ++i) EXPECT_EQ(position(i), glm::dvec3(1));
}

TEST_F(Pcd, ColoursComeInEveryPacking) {
    for (const std::string type : {"F", "U", "I"}) {
        std::string bytes;
        for (const float axis : {1.f, 2.f, 3.f}) put(bytes, axis);
        put(bytes, uint32_t{0xfe0a0b0c});
        read(header("x y z rgba", "4 4 4 4", "F F F " + type, "1 1 1 1", "") + grid(1, 1, "binary") + bytes);
        EXPECT_EQ(value(0, names::color, 0), 10) << type;
        EXPECT_EQ(value(0, names::color, 2), 12) << type;
        EXPECT_EQ(value(0, "alpha"), 0xfe) << type;
    }
    for (const std::string number : {"4262071052", "-32896244"}) {
        read(header("x y z rgba", "4 4 4 4", "F F F U", "1 1 1 1", "") + grid(1, 1, "ascii") + "1 2 3 " +
             number + "\n");
        EXPECT_EQ(value(0, names::color, 1), 11) << number;
        EXPECT_EQ(value(0, "alpha"), 0xfe) << number;
    }
    // A packed colour whose bits were lost in the text means no colour.
    for (const std::string none : {"nan", "-nan", "inf"}) {
        read(header("x y z rgba", "4 4 4 4", "F F F F", "1 1 1 1", "") + grid(1, 1, "ascii") + "1 2 3 " +
             none + "\n");
        for (size_t k = 0; k < 3; ++k) EXPECT_EQ(value(0, names::color, k), 188) << none;
        EXPECT_EQ(value(0, "alpha"), 255) << none;
    }
    // A packed colour beside another colour stays a field.
    read(header("x y z r g b rgb", "4 4 4 1 1 1 4", "F F F U U U U", "1 1 1 1 1 1 1", "") +
         grid(1, 1, "ascii") + "1 2 3 4 5 6 7\n");
    EXPECT_EQ(value(0, names::color, 0), 4);
    EXPECT_EQ(value(0, "rgb"), 7);
}

TEST_F(Pcd, ThousandsOfValuesWhoseNamesBeginAlikeAreNamedApartAtOnce) {
    const std::string name(70, 'Z');  // names are cut to 64 characters, so those of all values are the same
    read(header("x y z " + name, "4 4 4 1", "F F F U", "1 1 1 4000", "") + grid(1, 1, "binary") +
         std::string(4012, '\1'));
    ASSERT_EQ(points(), 1u);
    EXPECT_EQ(schema().attributes.size(), 4000u);
    EXPECT_EQ(schema().attributes.front().name, name.substr(0, 64));
    EXPECT_EQ(schema().attributes[1].name, name.substr(0, 64) + "_2");
    EXPECT_EQ(schema().attributes.back().name, name.substr(0, 64) + "_4000");
}

TEST_F(Pcd, DoublesAndWholeNumbersKeepEveryDigit) {
    read(header("x y z t", "8 8 4 8", "F F I U", "1 1 1 1", "") + grid(1, 1, "ascii") +
         "2600123.456789 1.1 -7 18446744073709551615\n");
    EXPECT_EQ(schema().position, PositionType::f64);
    EXPECT_EQ(position(0), glm::dvec3(2600123.456789, 1.1, -7));
    EXPECT_EQ(load<uint64_t>(&records_.bytes[schema().find("t")->offset]), UINT64_MAX);
}

TEST_F(Pcd, OnlyViewpointsThatSaySomethingAreStations) {
    const std::string fields = header("x y z", "4 4 4", "F F F", "1 1 1", "");
    const auto stations = [&](const std::string& size, const std::string& viewpoint) {
        read(fields + size + "VIEWPOINT " + viewpoint + " 1 0 0 0\nDATA ascii\n1 2 3\n1 2 3\n");
        return source_->info().stations.size();
    };
    EXPECT_EQ(stations("WIDTH 2\nHEIGHT 1\n", "0 0 0"), 0u);
    EXPECT_EQ(stations("WIDTH 2\nHEIGHT 1\n", "0 0 1"), 1u);
    EXPECT_EQ(stations("WIDTH 1\nHEIGHT 2\n", "0 0 0"), 1u);
}

TEST_F(Pcd, BinaryPointsArePickedByTheirIndex) {
    file_.set(kFields + grid(4, 1, "binary") + by_point());
    const auto source = open_scan(file_.path());
    ASSERT_TRUE(source && (*source)->seekable());
    PointBatch batch;
    const std::array<uint64_t, 3> indices = {0, 2, 3};
    ASSERT_TRUE((*source)->pick(indices, batch));
    ASSERT_EQ(batch.count, 2u);  // one is no number
    EXPECT_EQ(position_of((*source)->schema(), &batch.bytes[(*source)->schema().stride]).x, 4.5);
}

TEST_F(Pcd, HeadersThatContradictThemselvesAreRejected) {
    const std::string good = header("x y z", "4 4 4", "F F F", "1 1 1", grid(1, 1, "ascii")) + "1 2 3\n";
    read(good);
    const auto reason = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        text.replace(text.find(from), from.size(), to);
        const auto error = error_of(text);
        EXPECT_EQ(error.kind, ErrorKind::input_rejected) << to;
        return error.line();
    };
    EXPECT_THAT(reason("FIELDS x y z", "FIELDS x y"), HasSubstr("different lengths"));
    EXPECT_THAT(reason("FIELDS x y z", "FIELDS x y w"), HasSubstr("one field z"));
    EXPECT_THAT(reason("FIELDS x y z", "FIELDS"), HasSubstr("no FIELDS"));
    EXPECT_THAT(reason("SIZE 4 4 4", "SIZE 4 4 3"), HasSubstr("z of type F and size 3"));
    EXPECT_THAT(reason("SIZE 4 4 4", "SIZE 4 4 -4"), HasSubstr("'-4' for a SIZE"));
    EXPECT_THAT(reason("COUNT 1 1 1", "COUNT 1 1 2"), HasSubstr("one field z"));
    EXPECT_THAT(reason("COUNT 1 1 1", "COUNT 1 1 4294967295"), HasSubstr("more than 4096"));
    EXPECT_THAT(reason("WIDTH 1", "WIDTH 2"), HasSubstr("promises 2 x 1 points"));
    EXPECT_THAT(reason("WIDTH 1\nHEIGHT 1", "WIDTH 18446744073709551615\nHEIGHT 2"), HasSubstr("promises"));
    EXPECT_THAT(reason("POINTS 1", "POINTS many"), HasSubstr("no whole number for POINTS"));
    EXPECT_THAT(reason("WIDTH 1\nHEIGHT 1\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS 1", "POINTS 4000000000"),
                HasSubstr("is truncated"));
    EXPECT_THAT(reason("VIEWPOINT 1 2", "VIEWPOINT 1 nan"), HasSubstr("VIEWPOINT without seven"));
    EXPECT_THAT(reason("DATA ascii", "DATA huffman"), HasSubstr("unknown DATA 'huffman'"));
    EXPECT_THAT(reason("DATA ascii", "DATUM ascii"), HasSubstr("unknown entry 'DATUM'"));
    EXPECT_THAT(reason("DATA ascii\n1 2 3\n", ""), HasSubstr("without a DATA line"));
    EXPECT_THAT(reason("1 2 3\n", "1 22222\n"), HasSubstr("line 12 on: it has 2 values"));
    EXPECT_THAT(reason("1 2 3\n", "1 2 3\n4 5 6\n"), HasSubstr("has 2 rows"));
}

TEST_F(Pcd, LiesOfCompressedPointsAreRejected) {
    const std::string start = kFields + grid(2, 2, "binary_compressed");
    const std::string packed = stored(by_field());
    EXPECT_THAT(error_of(start + compressed(packed, by_field().size() + 1)).line(), HasSubstr("points take"));
    EXPECT_THAT(error_of(start + compressed(packed.substr(0, 40), by_field().size())).line(),
                HasSubstr("end early"));
    EXPECT_THAT(error_of(start + compressed(packed, by_field().size()).substr(0, 100)).line(),
                HasSubstr("is truncated"));
    EXPECT_THAT(error_of(start + compressed("\x20\x05" + packed, by_field().size())).line(),
                HasSubstr("before their beginning"));
    // Promises a gigabyte that is not there.
    EXPECT_THAT(
        error_of(kFields + grid(5000, 5000, "binary_compressed") + compressed(packed, 37u * 25000000u))
            .line(),
        HasSubstr("is truncated"));
}

TEST_F(Pcd, TruncationAnywhereIsRejected) {
    for (const std::string& file :
         {kFields + grid(2, 2, "ascii") + ascii(), kFields + grid(2, 2, "binary") + by_point(),
          kFields + grid(2, 2, "binary_compressed") + compressed(stored(by_field()), by_field().size())})
        for (size_t length = 1; length + 2 < file.size(); ++length)
            EXPECT_FALSE(error_of(std::string_view(file).substr(0, length)).why.empty()) << length;
}

TEST_F(Pcd, ChangedBytesNeverCrash) {
    const std::vector<std::string> seeds = {
        kFields + grid(2, 2, "ascii") + ascii(), kFields + grid(2, 2, "binary") + by_point(),
        kFields + grid(2, 2, "binary_compressed") + compressed(stored(by_field()), by_field().size())};
    Random random(13);
    for (int i = 0; i < 9000; ++i) {
        std::string file = seeds[static_cast<size_t>(i) % seeds.size()];
        const size_t from = i % 2 ? file.find("DATA") : 0;
        for (uint64_t k = 0; k <= random.next() % 4; ++k)
            file[from + random.next() % (file.size() - from)] = random.next() % 2
                                                                    ? "0123456789 \nFIUe-"[random.next() % 17]
                                                                    : static_cast<char>(random.next());
        const auto error = error_of(file);  // or none
        EXPECT_TRUE(error.why.empty() || error.kind == ErrorKind::input_rejected) << file;
    }
}

TEST_F(Pcd, WhatIsWrittenIsReadBackWhole) {
    Schema schema;
    schema.position = PositionType::i32_scaled;
    schema.scale = glm::dvec3(0.001);
    schema.offset = glm::dvec3(2600000, 1200000, 0);
    schema.stride = static_cast<uint32_t>(position_bytes(schema.position));
    schema.add("color", ScalarType::u8, 3);
    schema.add("alpha", ScalarType::u8);
    schema.add("gps_time", ScalarType::f64);
    schema.add("normal", ScalarType::f32, 3);
    schema.add("big number", ScalarType::u64);
    PointBatch batch;
    Random random(2);
    constexpr size_t kPoints = 100;
    for (size_t i = 0; i < kPoints * schema.stride; ++i)
        batch.bytes.push_back(static_cast<std::byte>(random.next()));
    ScanInfo info;
    info.stations = {{1, {2600001, 1200002, 3.5}}, {2, {4, 5, 6}}};
    info.metres_per_unit = 0.3048;
    const testing::TemporaryFolder folder;
    const auto path = folder / "a.pcd";
    const auto writer = create_scan(path, schema, info, {});
    ASSERT_TRUE(writer) << writer.error().line();
    ASSERT_TRUE((*writer)->write(batch.bytes));
    ASSERT_TRUE((*writer)->finish());
    const auto source = open_scan(path);
    ASSERT_TRUE(source) << source.error().line();
    EXPECT_EQ((*source)->info().metres_per_unit, 0.3048);
    ASSERT_EQ((*source)->info().stations.size(), 2u);
    EXPECT_EQ((*source)->info().stations[0].position, info.stations[0].position);
    const auto records = testing::read_all(**source);
    ASSERT_TRUE(records);
    ASSERT_EQ(records->count, kPoints);
    const Schema& back = (*source)->schema();
    for (size_t i = 0; i < kPoints; ++i) {
        const std::byte *was = &batch.bytes[i * schema.stride], *is = &records->bytes[i * back.stride];
        // Scaled coordinates are written as the decimal fractions that they stand for.
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(position_of(schema, was)[axis], position_of(back, is)[axis], 1e-9);
        for (const Attribute& a : schema.attributes) {
            const Attribute* b = back.find(a.name == "big number" ? "big_number" : a.name);
            ASSERT_TRUE(b && b->type == a.type && b->components == a.components) << a.name;
            EXPECT_EQ(std::memcmp(was + a.offset, is + b->offset, a.bytes()), 0) << a.name;
        }
    }
}

}  // namespace
}  // namespace lucarne::io
