// LAZ files whose header counts fewer or more points than their chunks hold.
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "io/formats/las/header.h"
#include "io/formats/las/layout.h"
#include "tests/io/formats/las/las_builder.h"
#include "tests/io/formats/scan_text.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;

const ReadOptions kSalvage{"", true, {}, true};
constexpr uint32_t kPoints = 60'000;  ///< in chunks of 50 000

/// The parameter is the format of the points.
class LazCounts : public testing::TextScan, public ::testing::WithParamInterface<int> {
 protected:
    void write(bool constant = false) {
        const auto format = static_cast<uint8_t>(GetParam());
        las::Header header;
        header.minor = format < 6 ? 2 : 4;
        header.point_format = format;
        header.record_length = las::record_bytes(format);
        header.scale = glm::dvec3(.001);
        const Schema schema = las::make_schema(header);
        std::vector<std::byte> records(size_t{kPoints} * schema.stride);
        std::mt19937 random(format);
        for (uint32_t i = 0; i < kPoints; ++i)
            for (size_t axis = 0; axis < 3; ++axis)
                store(&records[i * schema.stride + 4 * axis],
                      constant ? 7 : static_cast<int32_t>(1000 * i + random() % 1000));
        ScanInfo info;
        info.notes.las = header;
        const testing::TemporaryFolder folder;
        auto writer = create_scan(folder / "a.laz", schema, info, {});
        ASSERT_TRUE(writer) << writer.error().line();
        ASSERT_TRUE((*writer)->write(records));
        ASSERT_TRUE((*writer)->finish());
        sound_ = testing::read_bytes(folder / "a.laz");
        read(sound_);
        ASSERT_EQ(points(), kPoints);
        all_ = records_.bytes;
    }
    /// Returns the file with another number of points in its header.
    std::string counting(uint64_t count) const {
        std::string bytes = sound_;
        if (GetParam() < 6)
            testing::put(bytes, 107, static_cast<uint32_t>(count));
        else
            testing::put(bytes, 247, count);
        return bytes;
    }
    bool begins_like_all() const {
        return records_.bytes.size() <= all_.size() &&
               std::equal(records_.bytes.begin(), records_.bytes.end(), all_.begin());
    }

    std::string sound_;
    std::vector<std::byte> all_;
};

TEST_P(LazCounts, FewerThanThereAreAreFollowedAndWithSalvageAllAreRead) {
    write();
    for (const uint32_t count : {kPoints - 1, kPoints - 11, kPoints - 9'999, 50'000u, 49'999u, 7u}) {
        read(counting(count));
        EXPECT_EQ(points(), count);
        EXPECT_TRUE(begins_like_all()) << count;
        const auto contents = survey(*source_);
        ASSERT_TRUE(contents) << count;
        EXPECT_EQ(contents->losses, (Losses{{std::string(lost::uncounted), kPoints - count}})) << count;
        read(counting(count), kSalvage);
        EXPECT_TRUE(begins_like_all()) << count;
        EXPECT_EQ(points(), kPoints);
    }
    read(counting(0));
    EXPECT_EQ(points(), 0u);
    read(counting(0), kSalvage);
    EXPECT_EQ(points(), kPoints);
}

TEST_P(LazCounts, OfEqualPointsAreNeverMoreThanThereWere) {
    // Their code does not tell how many there are, so the header is believed as far as the code allows.
    write(true);
    for (const uint32_t count : {0u, 7u, 49'999u, 50'000u, kPoints - 11, kPoints - 1}) {
        for (const bool salvage : {false, true}) {
            read(counting(count), {"", true, {}, salvage});
            EXPECT_TRUE(begins_like_all()) << count;
            EXPECT_GE(points(), count);
        }
    }
}

TEST_P(LazCounts, MoreThanThereAreAreRejectedAndWithSalvageAllAreRead) {
    write();
    for (const uint64_t count : {uint64_t{kPoints + 1}, uint64_t{kPoints + 15}, uint64_t{99'999},
                                 uint64_t{100'000}, uint64_t{100'001}, uint64_t{1'000'000}}) {
        EXPECT_EQ(error_of(counting(count)).kind, ErrorKind::input_rejected) << count;
        read(counting(count), kSalvage);
        EXPECT_EQ(points(), kPoints) << count;
        EXPECT_TRUE(begins_like_all()) << count;
        const auto contents = survey(*source_);
        ASSERT_TRUE(contents) << count;
        EXPECT_EQ(contents->losses, (Losses{{std::string(lost::cut_off), count - kPoints}}));
    }
}

TEST_P(LazCounts, HostileCountsAreHarmless) {
    write();
    for (const uint64_t count : {uint64_t{1} << 31, uint64_t{UINT32_MAX}, uint64_t{1} << 63, UINT64_MAX}) {
        const bool cut = GetParam() < 6 && static_cast<uint32_t>(count) == 0;
        EXPECT_TRUE(cut || error_of(counting(count)).kind == ErrorKind::input_rejected) << count;
        (void)error_of(counting(count), kSalvage);
    }
}

TEST_P(LazCounts, DamageInTheLastChunkIsStillFound) {
    write();
    std::mt19937 random(9);
    size_t accepted = 0;
    constexpr size_t kTries = 24;
    for (size_t i = 0; i < kTries; ++i) {
        std::string bytes = i % 2 ? sound_ : counting(kPoints - 11);
        bytes[bytes.size() - 2'000 - random() % 4'000] ^= static_cast<char>(1 + random() % 255);
        accepted += error_of(bytes).why.empty();
    }
    EXPECT_LE(accepted, kTries / 8);
}

INSTANTIATE_TEST_SUITE_P(Formats, LazCounts, ::testing::Values(0, 3, 6, 7),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace lucarne::io
