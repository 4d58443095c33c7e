// Binary bodies of PLY and PCD that do not fit their header: surplus bytes, doubles instead of floats, padded
// records, and header lines with unusual ends.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/io/formats/scan_text.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;

template <class T>
void append(std::string& bytes, T value, bool swapped = false) {
    std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
    if (swapped) std::reverse(raw.begin(), raw.end());
    bytes += raw;
}

std::string ply_header(size_t points, const std::string& more = {}, const std::string& end = "\n",
                       const std::string& encoding = "little") {
    std::string header = "ply\nformat binary_" + encoding + "_endian 1.0\n" +
                         fmt::format("element vertex {}\n", points) +
                         "property float x\nproperty float y\nproperty float z\n" + more + "end_header\n";
    std::string changed;
    for (const char c : header) changed += c == '\n' ? end : std::string(1, c);
    return changed;
}
std::string pcd_header(size_t points, const std::string& end = "\n") {
    std::string header = fmt::format(
        "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {0}\nHEIGHT 1\nPOINTS "
        "{0}\nDATA "
        "binary\n",
        points);
    std::string changed;
    for (const char c : header) changed += c == '\n' ? end : std::string(1, c);
    return changed;
}

double coordinate(size_t i, int axis) {
    return (static_cast<double>(i) * 3 + axis + 1) / 7;
}
/// Returns `points` records of three coordinates, each with `padding` after them.
template <class T>
std::string body(size_t points, const std::string& padding = {}, bool swapped = false) {
    std::string bytes;
    for (size_t i = 0; i < points; ++i) {
        for (int axis = 0; axis < 3; ++axis) append(bytes, static_cast<T>(coordinate(i, axis)), swapped);
        bytes += padding;
    }
    return bytes;
}

class BinaryBody : public testing::TextScan {
 protected:
    std::string said_of(const std::string& bytes) {
        ::testing::internal::CaptureStderr();
        read(bytes);
        return ::testing::internal::GetCapturedStderr();
    }
    void expect_points(size_t count, double tolerance, const std::string& what) const {
        ASSERT_EQ(points(), count) << what;
        for (size_t i = 0; i < count; ++i)
            for (int axis = 0; axis < 3; ++axis)
                ASSERT_NEAR(position(i)[axis], coordinate(i, axis), tolerance) << what;
    }
};

TEST_F(BinaryBody, BytesBehindThePointsAreSaidAndLeftOut) {
    for (const std::string& header : {ply_header(20), pcd_header(20)})
        for (const size_t more : {1u, 5u, 12u, 80u, 241u}) {
            // Nothing that all records have in common.
            std::string rest;
            for (size_t i = 0; i < more; ++i) rest += static_cast<char>(i * 37 + 11);
            EXPECT_THAT(said_of(header + body<float>(20) + rest),
                        HasSubstr(more == 1 ? "1 byte follows the points"
                                            : fmt::format("{} bytes follow the points", more)));
            expect_points(20, 1e-6, header);
        }
    for (const std::string& header : {ply_header(20), pcd_header(20)})
        EXPECT_EQ(said_of(header + body<float>(20)), "");
}

TEST_F(BinaryBody, ElementsBehindTheVerticesAreNoSurplus) {
    const std::string more = "element camera 2\nproperty float view\n";
    EXPECT_EQ(said_of(ply_header(20, more) + body<float>(20) + std::string(8, '\1')), "");
    EXPECT_THAT(said_of(ply_header(20, more) + body<float>(20) + std::string(9, '\1')),
                HasSubstr("1 byte follows the points"));
    const std::string lists = "element camera 2\nproperty list uchar float view\n";
    EXPECT_EQ(said_of(ply_header(20, lists) + body<float>(20) + std::string(9, '\1')), "");
    expect_points(20, 1e-6, "lists");
}

TEST_F(BinaryBody, DoublesUnderAHeaderOfFloatsAreRead) {
    for (const std::string& header : {ply_header(20), pcd_header(20)}) {
        EXPECT_THAT(said_of(header + body<double>(20)), HasSubstr("its points are doubles"));
        expect_points(20, 0, header);
    }
    EXPECT_THAT(said_of(ply_header(20, {}, "\n", "big") + body<double>(20, {}, true)),
                HasSubstr("its points are doubles"));
    expect_points(20, 0, "big endian");
    // As many bytes, but of floats: twice as many points as stated.
    for (const std::string& header : {ply_header(20), pcd_header(20)}) {
        EXPECT_THAT(said_of(header + body<float>(40)), HasSubstr("240 bytes follow the points"));
        expect_points(20, 1e-6, header);
    }
}

TEST_F(BinaryBody, PaddingOfRecordsIsLeftOut) {
    std::string one;
    append(one, 1.f);  // as in the structures of PCL
    for (const std::string& header : {ply_header(20), pcd_header(20)}) {
        EXPECT_THAT(said_of(header + body<float>(20, one)), HasSubstr("16 bytes each instead of 12"));
        expect_points(20, 1e-6, header);
        EXPECT_TRUE(schema().attributes.empty());
    }
    EXPECT_THAT(said_of(ply_header(20, "property uchar red\nproperty uchar green\nproperty uchar blue\n") +
                        body<float>(20, std::string("\1\2\3\0", 4))),
                HasSubstr("16 bytes each instead of 15"));
    expect_points(20, 1e-6, "colour");
    EXPECT_EQ(value(19, names::color, 2), 3);
    EXPECT_EQ(source_->info().notes.ply->properties.size(), 6u);
    // Values that differ are no padding: they may belong behind all points.
    std::string bytes = body<float>(20);
    for (int i = 0; i < 20; ++i) append(bytes, static_cast<float>(i));
    EXPECT_THAT(said_of(ply_header(20) + bytes), HasSubstr("80 bytes follow the points"));
    expect_points(20, 1e-6, "80 bytes");
}

TEST_F(BinaryBody, PointsThatTheHeaderDoesNotCountAreReadWithSalvage) {
    for (const size_t counted : {size_t{0}, size_t{7}, size_t{19}})
        for (const std::string& header : {ply_header(counted), pcd_header(counted)}) {
            EXPECT_THAT(said_of(header + body<float>(20)),
                        HasSubstr(counted == 19 ? "1 record takes as many, and --salvage reads it"
                                                : "records take as many, and --salvage reads them"));
            EXPECT_EQ(points(), counted);
            read(header + body<float>(20), {"", true, {}, true});
            expect_points(20, 1e-6, header);
        }
    // Nothing but zeros, a part of a record, and values that are no coordinates.
    std::string odd;
    for (int i = 0; i < 30; ++i) append(odd, i % 3 ? 1e20f : 1.f);
    for (const std::string& rest : {std::string(120, '\0'), body<float>(5) + "x", odd})
        for (const std::string& header : {ply_header(20), pcd_header(20)}) {
            EXPECT_THAT(said_of(header + body<float>(20) + rest),
                        HasSubstr("more than its header promises\n"));
            read(header + body<float>(20) + rest, {"", true, {}, true});
            expect_points(20, 1e-6, header);
        }
}

TEST_F(BinaryBody, HeaderLinesMayEndInLineFeedAndCarriageReturn) {
    for (const std::string end : {"\n\r", "\r\n", "\n"})
        for (const std::string& header : {ply_header(20, {}, end), pcd_header(20, end)}) {
            EXPECT_EQ(said_of(header + body<float>(20)), "");
            expect_points(20, 1e-6, header);
            // A point may begin with the byte of a carriage return.
            std::string bytes = body<float>(20);
            bytes[0] = '\r';
            read(header + bytes);
            ASSERT_EQ(points(), 20u);
            EXPECT_NEAR(position(19).x, coordinate(19, 0), 1e-6);
        }
}

TEST_F(BinaryBody, HostileCountsAreRejected) {
    for (const size_t count : {size_t{1} << 63, SIZE_MAX, size_t{1} << 62, SIZE_MAX / 12 + 2})
        for (const std::string& header : {ply_header(count), pcd_header(count)}) {
            EXPECT_EQ(error_of(header + body<float>(20)).kind, ErrorKind::input_rejected);
            read(header + body<float>(20), {"", true, {}, true});
            EXPECT_EQ(points(), 20u);
        }
    for (const char* count : {"9223372036854775808", "18446744073709551615"}) {
        const std::string header = ply_header(20, fmt::format("element other {}\nproperty float v\n", count));
        EXPECT_EQ(error_of(header + body<float>(20)).kind, ErrorKind::input_rejected);
        read(header + body<float>(20), {"", true, {}, true});
        EXPECT_EQ(points(), 20u);
    }
}

}  // namespace
}  // namespace lucarne::io
