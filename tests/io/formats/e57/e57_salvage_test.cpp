// Damaged E57 files: a page with a wrong checksum costs the records that have bytes in it. Rays that hit
// nothing are no points, even where nothing marks them.
#include <algorithm>

#include <gmock/gmock.h>

#include "tests/io/formats/e57/e57_builder.h"
#include "tests/io/formats/scan_text.h"

namespace lucarne::io {
namespace {

using testing::BitStream;
using testing::BuiltFile;
using testing::BuiltScan;
using ::testing::HasSubstr;

const ReadOptions kSalvage{"", true, {}, true};

class E57Salvage : public testing::TextScan {
 protected:
    /// Returns a scan of `packets` packets of `each` points (i, i + .5, -i) with an intensity of 12 bits.
    static BuiltScan numbered(size_t packets, size_t each) {
        BuiltScan scan{
            testing::kXyzFields + testing::integer_field("intensity", 0, 4095), packets * each, {}};
        for (size_t p = 0; p < packets; ++p) {
            std::vector<std::array<double, 3>> points;
            BitStream intensity{12};
            for (size_t i = p * each; i < (p + 1) * each; ++i) {
                const auto number = static_cast<double>(i);
                points.push_back({number, number + .5, -number});
                intensity.add(uint64_t{i % 4096});
            }
            scan.packets += testing::xyz_packet(points, {intensity.bytes});
        }
        return scan;
    }
    /// Checks that all values of a point belong together, and returns how many points are missing.
    size_t missing(size_t promised) const {
        size_t wrong = 0;
        double before = -1;
        for (size_t i = 0; i < points(); ++i) {
            const glm::dvec3 at = position(i);
            wrong += at.y != at.x + .5 || at.z != -at.x || at.x <= before ||
                     value(i, names::intensity) != static_cast<int>(at.x) % 4096;
            before = at.x;
        }
        EXPECT_EQ(wrong, 0u);
        return promised - points();
    }
    uint64_t lost_of(std::string_view what) const {
        const auto contents = survey(*source_);
        if (!contents) return 0;
        for (const Loss& loss : contents->losses)
            if (loss.what == what) return loss.count;
        return 0;
    }
};

TEST_F(E57Salvage, LosesTheRecordsOfAPageAndNoOthers) {
    for (const auto& [packets, each] : {std::pair<size_t, size_t>{3, 2000}, {60, 100}}) {
        const std::string sound = BuiltFile{{numbered(packets, each)}}.bytes();
        const size_t all = packets * each, pages = sound.size() / e57::kPageBytes;
        size_t whole = 0, tried = 0;
        for (size_t page = 1; page + 3 < pages; page += 5) {
            std::string bytes = sound;
            bytes[page * e57::kPageBytes + 500] ^= '\x08';
            EXPECT_THAT(error_of(bytes).line(), HasSubstr("checksum"));
            read(bytes, kSalvage);
            const size_t gone = missing(all);
            EXPECT_EQ(lost_of(lost::damaged), gone) << page;
            // A page has 127 doubles, or 680 intensities of 12 bits.
            ++tried;
            whole += gone > 0 && gone <= 700;
        }
        EXPECT_GT(whole, tried * 8 / 10) << "of " << tried;
    }
}

TEST_F(E57Salvage, AScanWithoutRecordsNeedsNoFields) {
    BuiltScan empty;
    empty.records = 0;
    read(BuiltFile{{empty, numbered(1, 50), empty}}.bytes());
    EXPECT_EQ(points(), 50u);
    read(BuiltFile{{empty}}.bytes(), kSalvage);
    EXPECT_EQ(points(), 0u);
}

TEST_F(E57Salvage, EndsAScanWhereAPacketCannotBeMeasured) {
    const size_t each = 100;
    std::string bytes = BuiltFile{{numbered(60, each), numbered(1, 50)}}.bytes();
    // The beginning of the tenth packet.
    const size_t packet = numbered(1, each).packets.size();
    const size_t at = testing::physical(e57::kHeaderBytes + 32 + 9 * packet);
    for (const size_t byte : {0u, 2u, 3u, 4u, 6u, 9u}) {
        std::string damaged = bytes;
        damaged[testing::physical(e57::kHeaderBytes + 32 + 9 * packet + byte)] ^= '\x21';
        read(damaged, kSalvage);
        EXPECT_GE(points(), 800u + 50) << byte;
        EXPECT_LE(points(), 900u + 50) << byte;
        EXPECT_EQ(points() + lost_of(lost::damaged), 6050u) << byte;
    }
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at / e57::kPageBytes * e57::kPageBytes),
                e57::kPageBytes, '\0');
    read(bytes, kSalvage);
    EXPECT_EQ(points() + lost_of(lost::damaged), 6050u);
}

TEST_F(E57Salvage, ReadsADescriptionWithAWrongChecksumIfItMakesSense) {
    // The comment fills at least one page of its own.
    const std::string sound =
        BuiltFile{{numbered(2, 100)}, {}, "<!--" + std::string(2 * e57::kPageContent, '.') + "-->"}.bytes();
    std::string bytes = sound;
    bytes.back() ^= '\1';
    EXPECT_THAT(error_of(bytes).line(), HasSubstr("checksum"));
    read(bytes, kSalvage);
    EXPECT_EQ(points(), 200u);
    EXPECT_EQ(lost_of(e57::kWrongPages), 1u);
    bytes = sound;
    bytes[e57::kPageBytes - 1] ^= '\1';  // of the first page, with the file's header
    read(bytes, kSalvage);
    EXPECT_GE(points(), 100u - 43);
    EXPECT_EQ(lost_of(e57::kWrongPages), 1u);
}

TEST_F(E57Salvage, TheLastPageMayLackItsChecksum) {
    const std::string sound = BuiltFile{{numbered(2, 100)}}.bytes();
    for (size_t cut = 1; cut <= 4; ++cut) {
        const std::string bytes = sound.substr(0, sound.size() - cut);
        EXPECT_THAT(error_of(bytes).line(), HasSubstr("truncated"));
        read(bytes, kSalvage);
        EXPECT_EQ(points(), 200u) << cut;
        EXPECT_EQ(lost_of(e57::kWrongPages), 0u);
    }
}

TEST_F(E57Salvage, HostileCountsAreHarmless) {
    for (const char* count : {"9223372036854775807", "9223372036854775808", "18446744073709551615"}) {
        BuiltScan scan = numbered(2, 100);
        scan.record_count = count;
        const std::string bytes = BuiltFile{{scan}}.bytes();
        EXPECT_EQ(error_of(bytes).kind, ErrorKind::input_rejected) << count;
        if (try_read(bytes, kSalvage)) {
            EXPECT_EQ(points(), 200u) << count;
        }
    }
    for (const size_t field : {16u, 24u, 32u, 40u})  // of the file's header
        for (const uint64_t value : {uint64_t{1} << 63, UINT64_MAX, uint64_t{0}, uint64_t{1023}}) {
            std::string logical = BuiltFile{{numbered(2, 100)}}.logical();
            logical.replace(field, sizeof value, reinterpret_cast<const char*>(&value), sizeof value);
            (void)error_of(testing::with_checksums(logical), kSalvage);
        }
    for (const size_t field : {8u, 16u})  // of the section's header
        for (const uint64_t value : {uint64_t{1} << 63, UINT64_MAX, uint64_t{0}, uint64_t{1023}}) {
            BuiltScan scan = numbered(2, 100);
            scan.spoil = [&](std::string& section) {
                section.replace(field, sizeof value, reinterpret_cast<const char*>(&value), sizeof value);
            };
            (void)error_of(BuiltFile{{scan}}.bytes(), kSalvage);
        }
}

/// Returns a scan in which each third point is at its own origin.
BuiltScan with_zeros(size_t count, const std::string& more_fields, const std::string& pose = {}) {
    BuiltScan scan{testing::kXyzFields + more_fields, count, {}, pose};
    std::vector<std::array<double, 3>> points;
    std::string more;
    for (size_t i = 0; i < count; ++i) {
        const auto number = static_cast<double>(i);
        points.push_back(i % 3 == 0 ? std::array{0., 0., 0.} : std::array{number, 1., 2.});
        more += '\0';
    }
    scan.packets = testing::xyz_packet(
        points, more_fields.empty() ? std::vector<std::string>{} : std::vector<std::string>{more});
    return scan;
}

TEST_F(E57Salvage, PointsAtTheScannerItselfAreMissedRays) {
    const std::string pose =
        "<pose type=\"Structure\"><translation type=\"Structure\"><x type=\"Float\">10</x><y type=\"Float\">"
        "20</y><z type=\"Float\">30</z></translation></pose>";
    for (const std::string& placed : {std::string(), pose}) {
        read(BuiltFile{{with_zeros(300, "", placed)}}.bytes());
        EXPECT_EQ(points(), 200u);
        EXPECT_EQ(lost_of("rays that met nothing"), 100u);
        EXPECT_EQ(records_.dropped, 100u);
    }
    // A few may be points, and so may all of them.
    read(BuiltFile{{with_zeros(24, "")}}.bytes());
    EXPECT_EQ(points(), 24u);
    BuiltScan scan{testing::kXyzFields, 100, testing::xyz_packet({100, {0., 0., 0.}})};
    read(BuiltFile{{scan}}.bytes());
    EXPECT_EQ(points(), 100u);
    // Where states are given, they tell.
    read(BuiltFile{{with_zeros(300, testing::integer_field("cartesianInvalidState", 0, 255))}}.bytes());
    EXPECT_EQ(points(), 300u);
}

}  // namespace
}  // namespace lucarne::io
