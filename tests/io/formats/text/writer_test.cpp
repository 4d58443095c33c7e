// Text that Lucarne writes: its form, and that it reads back as the same bits.
#include <cmath>
#include <random>

#include <gmock/gmock.h>

#include "io/formats/common/decimal.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;
using testing::read_all;
using testing::read_bytes;
using ::testing::StartsWith;
using testing::TemporaryFolder;

std::string decimal(double scale, double offset, int32_t integer) {
    const auto made = text::Decimal::of(scale, offset);
    if (!made) return "none";
    char text[32];
    return {text, made->write(integer, text)};
}

TEST(Decimal, IsTheFractionThatTheScaledIntegerStandsFor) {
    EXPECT_EQ(decimal(0.01, 0, 63600176), "636001.76");
    EXPECT_EQ(decimal(0.001, 0, -5), "-0.005");
    EXPECT_EQ(decimal(0.001, 0, 0), "0.000");
    EXPECT_EQ(decimal(0.001, 2'600'000, 1), "2600000.001");
    EXPECT_EQ(decimal(0.00025, 515'000, -3), "514999.99925");
    EXPECT_EQ(decimal(1, 0, INT32_MIN), "-2147483648");
    EXPECT_EQ(decimal(100, 7, 3), "307");
    EXPECT_EQ(decimal(0.5, 0.25, 1), "0.75");
    EXPECT_EQ(decimal(-0.01, 0, 150), "-1.50");
}

TEST(Decimal, IsNotMadeOfWhatIsNoDecimalFraction) {
    EXPECT_EQ(decimal(1.0 / 3, 0, 1), "none");
    EXPECT_EQ(decimal(1.16451e-06, 1694038.123456789, 1), "none");
    EXPECT_EQ(decimal(0.01, 1e300, 1), "none");
    EXPECT_EQ(decimal(0.01, NAN, 1), "none");
}

/// A scan in memory.
class Made final : public PointSource {
 public:
    Schema schema_;
    ScanInfo info_;
    std::vector<std::byte> records;
    const Schema& schema() const override { return schema_; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override { return failed("a test", "writes only"); }
};

Result<void> write(const Made& scan, const std::filesystem::path& path) {
    LUCARNE_ASSIGN(const auto writer, create_scan(path, scan.schema_, scan.info_, {}));
    LUCARNE_TRY(writer->write(scan.records));
    return writer->finish();
}

/// Every type with any bits, including NaN and infinity.
Made everything(PositionType position, size_t points) {
    Made scan;
    scan.schema_.position = position;
    scan.schema_.scale = glm::dvec3(0.001);
    scan.schema_.offset = {2'600'000, 1'200'000, 0};
    scan.schema_.stride = static_cast<uint32_t>(position_bytes(position));
    scan.schema_.add("color", ScalarType::u16, 3);
    scan.schema_.add("normal", ScalarType::f32, 3);
    for (const auto type :
         {ScalarType::u8, ScalarType::i8, ScalarType::u16, ScalarType::i16, ScalarType::u32, ScalarType::i32,
          ScalarType::u64, ScalarType::i64, ScalarType::f32, ScalarType::f64})
        scan.schema_.add(std::string("a:") + std::string(scalar_name(type)), type);
    scan.schema_.add("Amplitude", ScalarType::f32);  // a name that others use for an intensity
    scan.schema_.add("Größe", ScalarType::u8);
    scan.info_.color_bits = 16;
    scan.info_.metres_per_unit = 0.3048;
    scan.info_.stations = {{3, {1.25, -2, 1e6}}};
    std::mt19937 random(7);
    scan.records.resize(points * scan.schema_.stride);
    for (auto& byte : scan.records) byte = static_cast<std::byte>(random());
    for (size_t i = 0; i < points; ++i) {
        std::byte* at = &scan.records[i * scan.schema_.stride];
        for (int axis = 0; axis < 3; ++axis) {
            const double value =
                std::ldexp(static_cast<double>(random()), static_cast<int>(random() % 60) - 50);
            if (position == PositionType::f32) store(at + 4 * axis, static_cast<float>(value));
            if (position == PositionType::f64) store(at + 8 * axis, value);
        }
    }
    return scan;
}

bool same_bits_or_nan(ScalarType type, const std::byte* a, const std::byte* b) {
    if (type == ScalarType::f32 || type == ScalarType::f64)
        if (std::isnan(scalar_at(type, a))) return std::isnan(scalar_at(type, b));
    return std::memcmp(a, b, scalar_bytes(type)) == 0;
}

TEST(TextWriter, WhatItWritesReadsBackAsTheSameBitsUnderTheSameNames) {
    const TemporaryFolder folder;
    for (const auto position : {PositionType::f64, PositionType::f32, PositionType::i32_scaled})
        for (const char* name : {"a.csv", "a.txt"}) {
            const Made scan = everything(position, 10'000);
            std::filesystem::remove(folder / name);
            const auto written = write(scan, folder / name);
            ASSERT_TRUE(written) << written.error().line();
            const auto copy = open_scan(folder / name);
            ASSERT_TRUE(copy) << copy.error().line();
            const auto records = read_all(**copy);
            ASSERT_TRUE(records) << records.error().line();
            ASSERT_EQ(records->count, 10'000u);
            const Schema& got = (*copy)->schema();
            EXPECT_EQ(got.position, position == PositionType::f32 ? PositionType::f32 : PositionType::f64);
            EXPECT_EQ(got.attributes.size(), scan.schema_.attributes.size());
            for (size_t i = 0; i < records->count; ++i) {
                const std::byte *was = &scan.records[i * scan.schema_.stride],
                                *is = &records->bytes[i * got.stride];
                const auto a = position_of(scan.schema_, was), b = position_of(got, is);
                for (int axis = 0; axis < 3; ++axis)
                    ASSERT_NEAR(a[axis], b[axis], position == PositionType::i32_scaled ? 2e-9 : 0.0);
                for (const Attribute& attribute : scan.schema_.attributes) {
                    const Attribute* other = got.find(attribute.name);
                    ASSERT_TRUE(other && other->type == attribute.type) << attribute.name;
                    for (uint32_t c = 0; c < attribute.components; ++c) {
                        const size_t at = c * scalar_bytes(attribute.type);
                        ASSERT_TRUE(same_bits_or_nan(attribute.type, was + attribute.offset + at,
                                                     is + other->offset + at))
                            << attribute.name << " of " << i;
                    }
                }
            }
            EXPECT_EQ((*copy)->info().color_bits, 16u);
            EXPECT_EQ((*copy)->info().metres_per_unit, 0.3048);
            ASSERT_EQ((*copy)->info().stations.size(), 1u);
            EXPECT_EQ((*copy)->info().stations[0].position, glm::dvec3(1.25, -2, 1e6));
        }
}

TEST(TextWriter, WritesAHeaderThatOthersRead) {
    const TemporaryFolder folder;
    Made scan;
    scan.schema_.position = PositionType::i32_scaled;
    scan.schema_.scale = glm::dvec3(0.01);
    scan.schema_.stride = 12;
    scan.schema_.add("intensity", ScalarType::u16);
    scan.schema_.add("color", ScalarType::u8, 3);
    scan.records.resize(scan.schema_.stride);
    store<int32_t>(&scan.records[0], 63600176);
    store<uint16_t>(&scan.records[12], 65535);
    for (const char* name : {"a.csv", "a.txt", "a.xyz"}) ASSERT_TRUE(write(scan, folder / name));
    EXPECT_THAT(read_bytes(folder / "a.csv"),
                ::testing::EndsWith("\nx,y,z,intensity,red,green,blue\n636001.76,0.00,0.00,65535,0,0,0\n"));
    EXPECT_THAT(read_bytes(folder / "a.csv"), StartsWith("# lucarne "));
    EXPECT_THAT(read_bytes(folder / "a.txt"),
                ::testing::EndsWith("\nx y z intensity red green blue\n636001.76 0.00 0.00 65535 0 0 0\n"));
    EXPECT_EQ(read_bytes(folder / "a.xyz"), "636001.76 0.00 0.00 65535 0 0 0\n");
}

/// Returns the most memory that this process ever held, in bytes.
uint64_t most_held() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) << 10;
    return 0;
}

TEST(TextWriter, WideRowsAskForBoundedMemory) {
    const TemporaryFolder folder;
    Made scan;
    scan.schema_.position = PositionType::f32;
    scan.schema_.stride = 12;
    scan.schema_.add("wide", ScalarType::u8, 4096);
    constexpr size_t kRows = 4096;
    scan.records.resize(kRows * scan.schema_.stride);
    const uint64_t before = most_held();
    const auto written = write(scan, folder / "a.xyz");
    ASSERT_TRUE(written) << written.error().line();
    EXPECT_EQ(std::filesystem::file_size(folder / "a.xyz"), kRows * (3 + 4096) * 2);
    EXPECT_LT(most_held() - before, uint64_t{200} << 20);
}

TEST(TextWriter, TakesNamesThatWouldBreakARow) {
    const TemporaryFolder folder;
    Made scan;
    scan.schema_.add("a, b;\"c\"\n", ScalarType::u8);
    scan.schema_.add("x", ScalarType::u8);
    scan.schema_.add("", ScalarType::u8);
    scan.records.resize(2 * scan.schema_.stride);
    ASSERT_TRUE(write(scan, folder / "a.csv"));
    const auto copy = open_scan(folder / "a.csv");
    ASSERT_TRUE(copy) << copy.error().line();
    EXPECT_EQ((*copy)->schema().attributes.size(), 3u);
    EXPECT_EQ(read_all(**copy)->count, 2u);
}

TEST(TextReader, PassesOverAColumnsCommentThatDoesNotFit) {
    const testing::MemoryFile file;
    for (const char* comment : {"x:f64,y:f64", "x:f64,y:f64,z:f64,a:u8,b:u8", "x,y,z,i", ":f64", ""}) {
        file.set(std::string("# lucarne columns ") + comment + "\n1 2 3 4\n5 6 7 8\n");
        const auto scan = open_scan(file.path(), {"", true});
        ASSERT_TRUE(scan) << scan.error().line();
        EXPECT_EQ(read_all(**scan)->count, 2u) << comment;
    }
}

}  // namespace
}  // namespace lucarne::io
