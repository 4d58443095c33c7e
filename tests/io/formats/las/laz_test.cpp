// LAZ beyond what the shared files cover: the coder itself, missing tables, truncation at every byte and many
// false values.
#include <random>

#include <gmock/gmock.h>

#include "io/formats/las/layout.h"
#include "io/formats/las/laz/color.h"
#include "io/formats/las/laz/decoder.h"
#include "io/formats/las/laz/encoder.h"
#include "io/formats/las/laz/integers.h"
#include "tests/io/formats/las/las_builder.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using testing::read_all;

TEST(LazCoder, GivesSymbolsBitsAndIntegersBack) {
    std::mt19937 random(1);
    for (const uint32_t symbols : {2u, 3u, 16u, 17u, 128u, 516u, 2048u}) {
        std::vector<uint32_t> values(20'000), plain(values.size());
        for (auto& value : values) value = random() % (random() % 4 ? 2 : symbols);  // mostly the first two
        for (auto& value : plain) value = random();
        laz::Encoder encoder;
        {
            laz::SymbolModel model(symbols);
            laz::BitModel bit;
            for (size_t i = 0; i < values.size(); ++i) {
                encoder.symbol(model, values[i]);
                encoder.bit(bit, values[i] & 1);
                if (i % 16 == 0)
                    encoder.bits(1 + i / 16 % 32, plain[i] & (0xffffffffu >> (31 - i / 16 % 32)));
            }
        }
        const auto bytes = encoder.finish();
        laz::Decoder decoder(bytes);
        laz::SymbolModel model(symbols);
        laz::BitModel bit;
        for (size_t i = 0; i < values.size(); ++i) {
            ASSERT_EQ(decoder.symbol(model), values[i]) << symbols << " symbols, the " << i << "th";
            ASSERT_EQ(decoder.bit(bit), values[i] & 1);
            if (i % 16 == 0) {
                ASSERT_EQ(decoder.bits(1 + i / 16 % 32), plain[i] & (0xffffffffu >> (31 - i / 16 % 32)));
            }
        }
        EXPECT_FALSE(decoder.failed());
        EXPECT_EQ(decoder.position(), bytes.data() + bytes.size())
            << "the code is read to its end and no further";
    }
}

TEST(LazCoder, GivesIntegersOfEveryWidthBackWhateverWasExpected) {
    std::mt19937 random(2);
    for (const uint32_t bits : {8u, 16u, 32u}) {
        const uint32_t mask = bits == 32 ? 0xffffffffu : (1u << bits) - 1;
        std::vector<std::pair<int32_t, int32_t>> pairs = {
            {0, 0}, {0, static_cast<int32_t>(mask)}, {static_cast<int32_t>(mask), 0}};
        if (bits == 32)
            pairs.insert(pairs.end(), {{0, INT32_MIN}, {INT32_MIN, INT32_MAX}, {INT32_MAX, INT32_MIN}});
        for (int i = 0; i < 20'000; ++i) {
            const auto expected = static_cast<int32_t>(random() & mask);
            const auto off = static_cast<int32_t>(random()) >> (random() % 32);
            pairs.emplace_back(
                expected,
                static_cast<int32_t>((static_cast<uint32_t>(expected) + static_cast<uint32_t>(off)) & mask));
        }
        laz::Encoder encoder;
        laz::IntegerModel there(bits, 2), back(bits, 2);
        for (const auto& [expected, value] : pairs) there.code(encoder, expected, value, value & 1);
        const auto bytes = encoder.finish();
        laz::Decoder decoder(bytes);
        for (const auto& [expected, value] : pairs)
            ASSERT_EQ(back.code(decoder, expected, 0, value & 1), value)
                << bits << " bits, expected " << expected;
        EXPECT_FALSE(decoder.failed());
    }
}

TEST(LazCoder, GivesColoursBack) {
    std::mt19937 random(3);
    std::vector<laz::Color> colors(5000);
    for (size_t i = 1; i < colors.size(); ++i) {
        colors[i] = colors[i - 1];
        if (random() % 3 == 0)
            for (auto& part : colors[i]) part = static_cast<uint16_t>(random() >> (random() % 32));
        if (random() % 5 == 0) colors[i][1] = colors[i][2] = colors[i][0];
    }
    laz::Encoder encoder;
    laz::ColorModel there, back;
    for (size_t i = 1; i < colors.size(); ++i) there.code(encoder, colors[i - 1], colors[i]);
    const auto bytes = encoder.finish();
    laz::Decoder decoder(bytes);
    for (size_t i = 1; i < colors.size(); ++i)
        ASSERT_EQ(back.code(decoder, colors[i - 1], {}), colors[i]) << i;
}

TEST(LazCoder, NeverReadsBeyondItsBytesAndSaysSo) {
    std::mt19937 random(4);
    for (size_t size = 0; size < 200; ++size) {
        std::vector<std::byte> bytes(size);
        for (auto& byte : bytes) byte = static_cast<std::byte>(size % 3 ? random() : 255);
        laz::Decoder decoder(bytes);
        laz::SymbolModel model(516);
        laz::IntegerModel integer(32);
        for (int i = 0; i < 2000; ++i) {
            ASSERT_LT(decoder.symbol(model), 516u);
            integer.code(decoder, i, 0);
        }
        EXPECT_TRUE(decoder.failed());
    }
}

/// A scan whose values change now and then, as in real scans, over four scanner channels and five pulse
/// trains.
class RestlessSource final : public PointSource {
 public:
    RestlessSource(uint8_t format, uint64_t points, unsigned seed) : extended_(las::extended_format(format)) {
        las::Header header;
        header.minor = format < 6 ? 2 : 4;
        header.point_format = format;
        header.record_length = static_cast<uint16_t>(las::record_bytes(format));
        schema_ = las::make_schema(header);
        schema_.add("amplitude", ScalarType::f32);
        schema_.add("echo", ScalarType::u8, 3);
        info_.path = "restless";
        info_.color_bits = 16;
        std::mt19937 random(seed);
        records_.resize(points * schema_.stride);
        std::vector<std::byte> last(schema_.stride);
        std::array<double, 5> times = {1e5, 3e8, -7, 0, 1e-300};
        for (size_t i = 0; i < points; ++i) {
            for (size_t b = 0; b < 12; ++b)  // coordinates: a few low bits, sometimes any bits
                if (b % 4 == 0 || random() % 64 == 0) last[b] = static_cast<std::byte>(random());
            for (const Attribute& a : schema_.attributes) {
                if (random() % 3) continue;
                if (a.name == names::gps_time) {
                    const size_t train = random() % times.size();
                    times[train] += random() % 50 ? 1e-5 * static_cast<double>(random() % 20) : 1e3;
                    store(&last[a.offset], times[train]);
                } else {
                    for (size_t b = 0; b < a.bytes(); ++b)
                        last[a.offset + b] = static_cast<std::byte>(random() >> (random() % 32));
                    if (const uint32_t bits = bits_of(a.name))
                        last[a.offset] &= static_cast<std::byte>((1u << bits) - 1);
                }
            }
            std::copy(last.begin(), last.end(),
                      records_.begin() + static_cast<std::ptrdiff_t>(i * schema_.stride));
        }
    }
    const Schema& schema() const override { return schema_; }
    const ScanInfo& info() const override { return info_; }
    Result<std::unique_ptr<PointReader>> open() const override { return tl::unexpected(Error{}); }
    const std::vector<std::byte>& records() const { return records_; }

 private:
    uint32_t bits_of(std::string_view name) const {
        if (name == names::return_number || name == names::number_of_returns || name == names::class_flags)
            return extended_ ? 4 : 3;
        if (name == names::classification && !extended_) return 5;
        if (name == names::scanner_channel) return 2;
        return name == names::scan_direction || name == names::edge_of_flight_line ? 1 : 0;
    }

    bool extended_;
    Schema schema_;
    ScanInfo info_;
    std::vector<std::byte> records_;
};

TEST(LazWriter, WhatItWritesIsReadBackInItsOrderBitByBit) {
    const testing::TemporaryFolder folder;
    for (const uint8_t format : {0, 1, 2, 3, 6, 7, 8})
        for (const uint64_t points : {1, 2, 3'000, 120'001}) {
            const RestlessSource source(format, points, format);
            const auto path = folder / "written.laz";
            auto writer = create_scan(path, source.schema(), source.info(), {.overwrite = true});
            ASSERT_TRUE(writer) << writer.error().line();
            ASSERT_TRUE((*writer)->write(source.records()));
            ASSERT_TRUE((*writer)->finish());
            const auto opened = open_scan(path);
            ASSERT_TRUE(opened) << opened.error().line();
            EXPECT_EQ((*opened)->schema().attributes, source.schema().attributes);
            EXPECT_THAT((*opened)->info().format,
                        ::testing::EndsWith("point format " + std::to_string(format)));
            EXPECT_EQ((*opened)->info().declared_points, points);
            const auto records = read_all(**opened, 777);
            ASSERT_TRUE(records) << records.error().line();
            EXPECT_TRUE(records->bytes == source.records()) << points << " points of format " << int{format};
        }
}

TEST(LazReader, ColoursAreSoughtInAllOfAChunk) {
    const testing::TemporaryFolder folder;
    Schema schema;
    schema.position = PositionType::i32_scaled;
    schema.stride = static_cast<uint32_t>(position_bytes(schema.position));
    schema.add(std::string(names::color), ScalarType::u16, 3);
    std::vector<std::byte> records(40'000 * schema.stride);
    for (const uint16_t brightest : {uint16_t{200}, uint16_t{40'000}}) {
        for (size_t i = 300; i < 40'000; ++i) store(&records[i * schema.stride + 12], brightest);
        ScanInfo info;
        info.color_bits = 16;  // written as they are
        auto writer = create_scan(folder / "dark.laz", schema, info, {.overwrite = true});
        ASSERT_TRUE(writer && (*writer)->write(records) && (*writer)->finish());
        EXPECT_EQ((*open_scan(folder / "dark.laz"))->info().color_bits, brightest > 255 ? 16u : 8u);
    }
}

TEST(LazWriter, AScanWithoutPointsIsAFileWithoutPoints) {
    const testing::TemporaryFolder folder;
    const RestlessSource source(7, 0, 1);
    auto writer = create_scan(folder / "empty.laz", source.schema(), source.info(), {});
    ASSERT_TRUE(writer && (*writer)->finish());
    const auto opened = open_scan(folder / "empty.laz");
    ASSERT_TRUE(opened) << opened.error().line();
    EXPECT_EQ(read_all(**opened)->count, 0u);
}

/// tests/io/formats/las/channels*.laz, made by LASzip (tests/oracles/laz_channels.py): point formats 6 to 8.
class LazChannels : public ::testing::TestWithParam<int> {
 protected:
    static constexpr uint64_t kPoints = 240;
    std::string file() const {
        return LUCARNE_SOURCE_DIR "/tests/io/formats/las/channels" + std::to_string(GetParam()) + ".laz";
    }
    static uint32_t value(uint64_t i, uint64_t k) {
        return static_cast<uint32_t>(i / (1 + k % 4) * 2654435761 + k * 2246822519) >> 16;
    }
    static uint32_t channel(uint64_t i) { return i < 80 ? i / 5 % 4 : i < 160 ? value(4 * i, 3) % 4 : 2; }
};

TEST_P(LazChannels, EveryValueIsThatOfItsPoint) {
    const auto scan = open_scan(file());
    ASSERT_TRUE(scan) << scan.error().line();
    const auto all = read_all(**scan);
    ASSERT_TRUE(all) << all.error().line();
    ASSERT_EQ(all->count, kPoints);
    struct Value {
        std::string_view name;
        size_t component, k, bits;
    };
    std::vector<Value> values = {{names::intensity, 0, 3, 16},      {names::classification, 0, 4, 8},
                                 {names::user_data, 0, 5, 8},       {names::scan_angle, 0, 6, 12},
                                 {names::point_source_id, 0, 7, 2}, {names::gps_time, 0, 8, 10}};
    size_t k = 9;
    for (size_t c = 0; c < 3 && GetParam() > 6; ++c)
        values.push_back({names::color, c, k++, c < 2 ? 16u : 8u});
    if (GetParam() == 8) values.push_back({names::nir, 0, k++, 16});
    values.push_back({"first", 0, k++, 8});
    values.push_back({"second", 0, k, 2});
    const Schema& schema = (*scan)->schema();
    const auto at = [&](uint64_t i, const Value& v) {
        const Attribute& a = *schema.find(v.name);
        return scalar_at(a.type,
                         &all->bytes[i * schema.stride + a.offset + v.component * scalar_bytes(a.type)]);
    };
    for (uint64_t i = 0; i < kPoints; ++i) {
        EXPECT_EQ(at(i, {names::scanner_channel, 0, 0, 0}), channel(i)) << i;
        for (uint64_t axis = 0; axis < 3; ++axis)
            EXPECT_EQ(load<int32_t>(&all->bytes[i * schema.stride + 4 * axis]),
                      static_cast<int32_t>(value(i, axis) % (axis < 2 ? 1u << 16 : 256u)));
        for (const Value& v : values)
            EXPECT_EQ(at(i, v), value(i, v.k) % (1u << v.bits)) << v.name << " of point " << i;
    }
}

INSTANTIATE_TEST_SUITE_P(Formats, LazChannels, ::testing::Values(6, 7, 8),
                         [](const auto& format) { return "Of" + std::to_string(format.param); });

/// Returns the compressed points of a file with one chunk.
std::string chunk_of(const std::string& path) {
    const std::string bytes = testing::read_bytes(path);
    const auto* b = reinterpret_cast<const std::byte*>(bytes.data());
    const auto points = load<uint32_t>(b + 96);
    return bytes.substr(points + 8, load<uint64_t>(b + points) - points - 8);
}

/// Files made by LASzip: point formats 0 to 3 (tests/oracles/laz_items.py) and 6 to 8 (laz_channels.py).
class LaszipFile : public ::testing::TestWithParam<const char*> {};

TEST_P(LaszipFile, WrittenAgainItHasTheSameBytesAndPointFormat) {
    const std::string file = std::string(LUCARNE_SOURCE_DIR "/tests/io/formats/las/") + GetParam() + ".laz";
    const testing::TemporaryFolder folder;
    const auto scan = open_scan(file);
    ASSERT_TRUE(scan) << scan.error().line();
    const auto all = read_all(**scan);
    ASSERT_TRUE(all) << all.error().line();
    const auto writer = create_scan(folder / "again.laz", (*scan)->schema(), (*scan)->info(), {});
    ASSERT_TRUE(writer) << writer.error().line();
    ASSERT_TRUE((*writer)->write(all->bytes) && (*writer)->finish());
    EXPECT_EQ((*open_scan(folder / "again.laz"))->info().format, (*scan)->info().format);
    EXPECT_EQ(chunk_of(folder / "again.laz"), chunk_of(file));
}

INSTANTIATE_TEST_SUITE_P(Formats, LaszipFile,
                         ::testing::Values("items0", "items1", "items2", "items3", "channels6", "channels7",
                                           "channels8"),
                         [](const auto& file) { return file.param; });

class LazFile : public ::testing::TestWithParam<const char*> {
 protected:
    void SetUp() override {
        const auto folder = testing::shared_data();
        if (folder.empty()) GTEST_SKIP() << "the shared data is not here";
        bytes_ = testing::read_bytes(folder / "las" / GetParam());
    }
    /// Reads these bytes. Returns the records, or the error.
    Result<testing::Records> read(const std::string& bytes) const {
        testing::write_bytes(folder_ / "changed.laz", bytes);
        auto source = open_scan(folder_ / "changed.laz");
        if (!source) return tl::unexpected(source.error());
        return read_all(**source);
    }
    uint32_t points_offset() const { return load<uint32_t>(reinterpret_cast<const std::byte*>(&bytes_[96])); }

    const testing::TemporaryFolder folder_;
    std::string bytes_;
};

TEST_P(LazFile, ReadsTheSameWhereTheChunkTableIsMissingOrZero) {
    const auto whole = read(bytes_);
    ASSERT_TRUE(whole) << whole.error().line();
    for (const char fill : {'\0', '\xff'}) {
        std::string bytes = bytes_;
        bytes.replace(points_offset(), 8, 8, fill);
        const auto again = read(bytes);
        ASSERT_TRUE(again) << again.error().line();  // layered chunks of variable size state their size
        EXPECT_EQ(again->bytes, whole->bytes);
    }
}

TEST_P(LazFile, WhereTheLastBytesWereNeverWrittenItIsRejected) {
    std::string bytes = bytes_;
    std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2), bytes.end(), '\0');
    EXPECT_FALSE(read(bytes));
}

TEST_P(LazFile, MorePointsThanItsBytesCanHoldAreRejectedUnread) {
    std::string bytes = bytes_;
    for (const size_t at : {size_t{107}, size_t{247}}) testing::put(bytes, at, uint32_t{40'000'000});
    const auto got = read(bytes);
    ASSERT_FALSE(got);
    EXPECT_THAT(got.error().line(), ::testing::HasSubstr("more than its"));
}

TEST_P(LazFile, TruncatedAnywhereItIsRejected) {
    for (size_t size = 0; size < bytes_.size(); size += 1 + bytes_.size() / 97) {
        const auto cut = read(bytes_.substr(0, size));
        if (cut) continue;  // only records after the points are missing
        EXPECT_EQ(cut.error().kind, ErrorKind::input_rejected) << size << ": " << cut.error().line();
    }
    EXPECT_FALSE(read(bytes_.substr(0, points_offset() + 300)));
}

TEST_P(LazFile, ChangedBytesGiveAnErrorOrPointsAndNothingElse) {
    std::mt19937 random(5);
    for (int i = 0; i < 120; ++i) {
        std::string bytes = bytes_;
        const size_t from = i % 3 ? points_offset() : 0;
        for (int n = 0; n < 1 + i % 4; ++n)
            bytes[from + random() % (bytes.size() - from)] = static_cast<char>(random());
        (void)read(bytes);
    }
}

INSTANTIATE_TEST_SUITE_P(Shared, LazFile,
                         ::testing::Values("liblas-generated.laz", "1.2-with-color.copc.laz"),
                         [](const auto& named) { return named.index ? "Layered" : "PointWise"; });

}  // namespace
}  // namespace lucarne::io
