// What follows the points that a LAS header counts: other points, records, or nothing that has a meaning.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/io/formats/las/las_builder.h"
#include "tests/io/formats/scan_text.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;
using testing::LasFile;
using testing::record0;

const ReadOptions kSalvage{"", true, {}, true};

class LasSurplus : public testing::TextScan {
 protected:
    static LasFile five() {
        LasFile file;
        file.box = {0, 1};
        for (int i = 1; i <= 5; ++i) file.records.push_back(record0(10 * i, i, i));
        return file;
    }
    /// Returns what is said while a file is read without --salvage.
    std::string said_of(const std::string& bytes) {
        ::testing::internal::CaptureStderr();
        read(bytes);
        return ::testing::internal::GetCapturedStderr();
    }
};

TEST_F(LasSurplus, PointsThatTheHeaderDoesNotCountAreReadWithSalvage) {
    for (const int counted : {0, 1, 4}) {
        LasFile file = five();
        file.said_points = file.said_old_points = counted;
        EXPECT_THAT(said_of(file.bytes()),
                    HasSubstr(fmt::format("{} bytes follow the points", 20 * (5 - counted))));
        EXPECT_EQ(points(), static_cast<size_t>(counted));
        read(file.bytes(), kSalvage);
        ASSERT_EQ(points(), 5u) << counted;
        EXPECT_EQ(position(4), glm::dvec3(.5, .05, .05));
        EXPECT_TRUE(source_->info().losses.empty());
    }
    LasFile file = five();
    file.said_points = file.said_old_points = 3;
    EXPECT_THAT(said_of(file.bytes()), HasSubstr("2 records take as many, and --salvage reads them"));
    EXPECT_EQ(said_of(five().bytes()), "");
}

TEST_F(LasSurplus, BytesThatAreNoPointsStayOut) {
    const std::string sound = five().bytes();
    const std::string far = record0(1 << 30, 1, 1), empty(20, '\0'), rest(7, 'x');
    for (const std::string& behind : {far, empty, rest, empty + empty + rest, far + record0(1, 1, 1)}) {
        EXPECT_THAT(said_of(sound + behind),
                    HasSubstr(fmt::format("{} bytes follow the points", behind.size())));
        EXPECT_EQ(points(), 5u);
        read(sound + behind, kSalvage);
        EXPECT_EQ(points(), 5u);
    }
    // Without a box nothing tells points from other bytes, unless there is no point at all.
    LasFile file = five();
    file.box = {0, 0};
    file.said_points = file.said_old_points = 2;
    read(file.bytes(), kSalvage);
    EXPECT_EQ(points(), 2u);
    file.said_points = file.said_old_points = 0;
    read(file.bytes() + empty, kSalvage);
    EXPECT_EQ(points(), 5u);
}

TEST_F(LasSurplus, ExtendedRecordsAreNone) {
    LasFile file = five();
    file.minor = 4;
    file.add_vlr("someone", 7, std::string(200, '\1'), true);
    EXPECT_EQ(said_of(file.bytes()), "");
    read(file.bytes(), kSalvage);
    EXPECT_EQ(points(), 5u);
    // They end the points, if the header promises too many.
    file.said_points = file.said_old_points = 9;
    read(file.bytes(), kSalvage);
    EXPECT_EQ(points(), 5u);
    EXPECT_EQ(source_->info().losses, (Losses{{std::string(lost::cut_off), 4}}));
    file.said_points = file.said_old_points = 3;
    EXPECT_THAT(said_of(file.bytes()), HasSubstr("40 bytes follow the points"));
    read(file.bytes(), kSalvage);
    EXPECT_EQ(points(), 5u);
}

TEST_F(LasSurplus, HostileCountsAndPlacesAreHarmless) {
    LasFile file = five();
    file.minor = 4;
    file.add_vlr("someone", 7, "x", true);
    for (const int64_t number :
         {int64_t{0}, int64_t{1}, int64_t{376}, int64_t{480}, INT64_MAX, INT64_MIN + 1}) {
        for (int64_t* said : {&file.said_points, &file.said_evlr_offset}) {
            *said = number;
            read(file.bytes(), kSalvage);
            EXPECT_LE(points(), 8u);
            *said = -1;
        }
    }
}

TEST_F(LasSurplus, Las15IsReadWithEitherSizeOfItsHeader) {
    LasFile file = five();
    file.minor = 5;
    std::string bytes = file.bytes();
    read(bytes);
    EXPECT_EQ(points(), 5u);
    EXPECT_THAT(source_->info().format, HasSubstr("LAS 1.5"));
    // The least and greatest GPS time and the time offset follow the header of LAS 1.4.
    bytes.insert(375, std::string(16, '\0') + "\xe8\x03");
    testing::put<uint16_t>(bytes, 94, 393);
    testing::put<uint32_t>(bytes, 96, 393);
    testing::put<uint64_t>(bytes, 235, 0);
    read(bytes);
    ASSERT_EQ(points(), 5u);
    EXPECT_EQ(position(4), glm::dvec3(.5, .05, .05));
    EXPECT_TRUE(source_->info().losses.empty());
    testing::put<uint16_t>(bytes, 6, 1 << 6);  // the time offset counts
    read(bytes);
    EXPECT_EQ(source_->info().losses.size(), 1u);
    EXPECT_EQ(source_->info().notes.las->minor, 4);
    bytes[25] = 6;
    EXPECT_THAT(error_of(bytes).line(), HasSubstr("LAS 1.6"));
}

}  // namespace
}  // namespace lucarne::io
