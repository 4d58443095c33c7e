// PTX: scans are placed by their poses; rays that hit nothing are dropped and counted.
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "io/core/random.h"
#include "tests/io/formats/scan_text.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;

class Ptx : public testing::TextScan {};

const std::string kIdentity = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
/// Turned by 90 degrees about z, 2 600 000 east, 1 200 000 north, 450 up.
const std::string kTurned =
    "2600000 1200000 450\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n2600000 1200000 450 1\n";

TEST_F(Ptx, PosesAreAppliedInDoublesAndBecomeStations) {
    read("2\n1\n" + kTurned +
         "1.0001 2.0002 3.0003 0.5 10 20 30\n-1 0 0 0.25 255 0 1\n"
         "1\n2\n" +
         kIdentity + "7 8 9 1\n0 0 0 0.5\n");
    ASSERT_EQ(points(), 3u);
    EXPECT_EQ(records_.dropped, 1u);
    EXPECT_EQ(source_->info().declared_points, 4u);
    EXPECT_EQ(position(0), glm::dvec3(2600000 - 2.0002, 1200000 + 1.0001, 450 + 3.0003));
    EXPECT_EQ(position(1), glm::dvec3(2600000, 1199999, 450));
    EXPECT_EQ(position(2), glm::dvec3(7, 8, 9));
    EXPECT_EQ(value(0, names::intensity), 0.5);
    EXPECT_EQ(value(1, names::color, 0), 255);
    EXPECT_EQ(value(2, names::color, 0), 0);  // this scan has none
    const auto& stations = source_->info().stations;
    ASSERT_EQ(stations.size(), 2u);
    EXPECT_EQ(stations[0].position, glm::dvec3(2600000, 1200000, 450));
    for (size_t i = 0; i < 3; ++i) EXPECT_EQ(value(i, names::point_source_id), stations[i / 2].id);
}

TEST_F(Ptx, ScansInTheWorldStandAtTheirScannersPosition) {
    read("1\n1\n10 20 30\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n11 21 31 0\n");
    EXPECT_EQ(source_->info().stations[0].position, glm::dvec3(10, 20, 30));
    EXPECT_EQ(position(0), glm::dvec3(11, 21, 31));
}

TEST_F(Ptx, RowsHaveThreeFourOrSevenValuesAndMissedRaysMayHaveFewer) {
    read("1\n1\n" + kIdentity + "1 2 3\n");
    EXPECT_TRUE(schema().attributes.empty());
    read("1\n3\n" + kIdentity + "0 0 0 0\n1 2 3 .5 1 2 3\n0 0 0 .5\n");
    EXPECT_EQ(points(), 1u);
    EXPECT_EQ(records_.dropped, 2u);
    EXPECT_EQ(value(0, names::color, 2), 3);
    EXPECT_THAT(error_of("1\n1\n" + kIdentity + "1 2 3 4 5\n").line(), HasSubstr("line 11 has 5 values"));
    EXPECT_THAT(error_of("1\n2\n" + kIdentity + "1 2 3 4\n1 2 3\n").line(),
                HasSubstr("line 12 on: it has 3 values"));
    EXPECT_THAT(error_of("1\n1\n" + kIdentity + "1 2 3 4 5 6 256\n").line(), HasSubstr("no value for blue"));
}

TEST_F(Ptx, LineEndsAndBlankLinesBetweenScansDoNotMatter) {
    std::string text = "1\n1\n" + kIdentity + "1 2 3 0\n\n\n1\n1\n" + kIdentity + "4 5 6 0";
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string changed;
        for (const char c : text) changed += c == '\n' ? end : std::string(1, c);
        read(changed);
        ASSERT_EQ(points(), 2u);
        EXPECT_EQ(position(1), glm::dvec3(4, 5, 6));
    }
}

TEST_F(Ptx, ScansWithoutRaysAreNoError) {
    read("0\n5\n" + kIdentity);
    EXPECT_EQ(points(), 0u);
    read("0\n0\n" + kIdentity + "1\n1\n" + kTurned + "1 0 0 0\n");
    EXPECT_EQ(points(), 1u);
    EXPECT_EQ(value(0, names::point_source_id), 2);
}

TEST_F(Ptx, LiesOfAHeaderAreRejected) {
    EXPECT_THAT(error_of("4000000000\n4000000000\n" + kIdentity + "1 2 3 4\n").line(),
                HasSubstr("is truncated"));
    EXPECT_THAT(error_of("9999999999999999999999\n1\n" + kIdentity).line(), HasSubstr("its header"));
    EXPECT_THAT(error_of("2\n3\n" + kIdentity + "1 2 3 4\n").line(),
                HasSubstr("5 of 6 points of a scan are missing"));
    EXPECT_THAT(error_of("1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0\n").line(),
                HasSubstr("line 8 is not four"));
    EXPECT_THAT(error_of("1\n1\n0 0 0\n1 0 nan\n").line(), HasSubstr("line 4 is not three"));
    EXPECT_THAT(error_of("1\n1\n" + kIdentity + "1 2 3 4\n1 2 3 4\n").line(),
                AllOf(HasSubstr("number of columns or rows"), HasSubstr("--salvage reads it")));
    EXPECT_THAT(error_of("1\n1\n" + kIdentity + "1 2 3 4\n1\n1\n0 0 0\n").line(),
                HasSubstr("ends within the header"));
}

TEST_F(Ptx, LargeScansEndWhereTheyShould) {
    // Longer than the reader's buffers: the second header is found by counting lines.
    std::string text = "1000\n150\n" + kIdentity;
    for (int i = 0; i < 150000; ++i) text += fmt::format("{} {:.6f} 1 0.5\n", i + 1, i / 7.0);
    text += "1\n2\n" + kTurned + "1 2 3 4\n0 0 0 0\n";
    read(text);
    EXPECT_EQ(points(), 150001u);
    EXPECT_EQ(position(149999).x, 150000);
    EXPECT_EQ(value(150000, names::point_source_id), 2);
}

TEST_F(Ptx, TruncationAnywhereIsRejected) {
    const std::string text =
        "2\n1\n" + kTurned + "1 2 3 0.5 10 20 30\n-1 0 0 0.25 255 0 1\n1\n1\n" + kIdentity + "7 8 9 1 1 1 1";
    const size_t second = text.find("\n1\n1\n0 0") + 1;
    const size_t last = text.rfind('\n') + 6;  // after this place a shorter row is still a row
    for (size_t length = 1; length < last; ++length) {
        if (length == second || length + 1 == second) continue;
        EXPECT_FALSE(error_of(text.substr(0, length)).why.empty()) << length;
    }
}

const ReadOptions kSalvage{"", true, {}, true};

/// Returns rows of points that are equal in their own frame, in order.
std::string rows_of(int count, int first = 0) {
    std::string rows;
    for (int i = 0; i < count; ++i) rows += fmt::format("{} 2.5 3.25 0.5 10 20 30\n", first + i + 1);
    return rows;
}

TEST_F(Ptx, AHeaderBeforeItsTimeEndsTheScanBeforeIt) {
    const std::string text = "3\n20\n" + kIdentity + rows_of(40) + "1\n2\n" + kTurned + rows_of(2);
    EXPECT_THAT(error_of(text).line(),
                HasSubstr("the next scan begins at line 51, but 20 of 60 points of the scan before it are "
                          "missing"));
    read(text, kSalvage);
    ASSERT_EQ(points(), 42u);
    EXPECT_EQ(position(39), glm::dvec3(40, 2.5, 3.25));
    EXPECT_EQ(position(40), glm::dvec3(2600000 - 2.5, 1200001, 453.25));
    EXPECT_EQ(value(39, names::point_source_id), 1);
    EXPECT_EQ(value(40, names::point_source_id), 2);
    const auto contents = survey(*source_);
    ASSERT_TRUE(contents);
    EXPECT_EQ(contents->losses, (Losses{{std::string(lost::cut_off), 20}}));
}

TEST_F(Ptx, SalvageTakesTheRowsThatFollowAHeaderWhateverItPromises) {
    for (const char* counts :
         {"1\n1\n", "0\n0\n", "9223372036854775808\n9223372036854775808\n", "4000000000\n4000000000\n"}) {
        const std::string text = "1\n2\n" + kTurned + rows_of(2) + counts + kIdentity + rows_of(5) +
                                 "1\n1\n" + kTurned + rows_of(1);
        EXPECT_EQ(error_of(text).kind, ErrorKind::input_rejected) << counts;
        read(text, kSalvage);
        ASSERT_EQ(points(), 8u) << counts;
        EXPECT_EQ(position(6), glm::dvec3(5, 2.5, 3.25)) << counts;
        EXPECT_EQ(position(7), glm::dvec3(2600000 - 2.5, 1200001, 453.25)) << counts;
    }
}

TEST_F(Ptx, SalvageLeavesOutScansWhosePlaceIsNotKnown) {
    const std::string first = "4\n10\n" + kIdentity + rows_of(40), second = "2\n10\n" + kTurned + rows_of(20),
                      third = "1\n5\n" + kIdentity + rows_of(5, 1000);
    const size_t begin = first.size(), end = begin + second.find("1 2.5") - 1;
    const auto check = [&](const std::string& text, const std::string& what) {
        if (!try_read(text, kSalvage)) return ADD_FAILURE() << what;
        size_t turned = 0, own = 0;
        for (size_t i = 0; i < points(); ++i) {
            // The rows of the second scan are turned, or they are not there.
            const glm::dvec3 at = position(i);
            (at.x > 1e6 ? turned : own) += 1;
            EXPECT_TRUE(at.x > 1e6 || at.y == 2.5) << what;
        }
        EXPECT_TRUE(turned == 0 || turned == 20) << what << ' ' << turned;
        EXPECT_GE(own, 44u) << what;
        EXPECT_LE(own, 45u) << what;
    };
    // A changed byte of the second header.
    for (size_t at = begin; at < end; ++at) {
        std::string text = first + second + third;
        text[at] = 'x';
        check(text, fmt::format("byte {} of the header", at - begin));
    }
    // The header and some rows around it overwritten.
    for (size_t before = 0; before < 200; before += 7)
        for (size_t after = 0; after < 200; after += 31) {
            std::string text = first + second + third;
            std::fill(text.begin() + static_cast<std::ptrdiff_t>(begin - before),
                      text.begin() + static_cast<std::ptrdiff_t>(end + after), '\0');
            if (!try_read(text, kSalvage)) {
                ADD_FAILURE() << before << ' ' << after;
                continue;
            }
            EXPECT_GE(points(), 40 - (before + 23) / 24 + 5) << before << ' ' << after;
            for (size_t i = 0; i < points(); ++i) {
                const glm::dvec3 at = position(i);
                EXPECT_EQ(at.x, i < points() - 5 ? static_cast<double>(i + 1)
                                                 : static_cast<double>(1001 + i - (points() - 5)));
            }
        }
    // The second header has lost its counts.
    check(first + "2x\n10\n" + kTurned + rows_of(20) + third, "no counts");
    check(first + kTurned + rows_of(20) + third, "no lines of counts");
}

TEST_F(Ptx, SalvageKeepsTheRowsBehindOneThatIsDamaged) {
    std::string text = "1\n60\n" + kIdentity + rows_of(60);
    const std::string whole = text;
    text[text.find("\n30 2.5") + 4] = '?';
    EXPECT_EQ(error_of(text).kind, ErrorKind::input_rejected);
    read(text, kSalvage);
    EXPECT_EQ(points(), 59u);
    // Ten rows overwritten: what is missing is as much as what cannot be read.
    text = whole;
    const size_t from = text.find("\n30 2.5") + 3;
    std::fill_n(text.begin() + static_cast<std::ptrdiff_t>(from), 240, '\0');
    read(text, kSalvage);
    EXPECT_GE(points(), 48u);
    EXPECT_EQ(position(points() - 1).x, 60);
}

TEST_F(Ptx, BlankLinesBetweenRowsAreNoRows) {
    read("1\n3\n" + kIdentity + "1 2 3 0\n\n4 5 6 0\n  \n7 8 9 0\n\n1\n1\n" + kTurned + "0 0 1 0\n");
    ASSERT_EQ(points(), 4u);
    EXPECT_EQ(position(3), glm::dvec3(2600000, 1200000, 451));
}

TEST_F(Ptx, ChangedBytesNeverCrash) {
    const std::string seed =
        "2\n1\n" + kTurned + "1 2 3 0.5 10 20 30\n-1 0 0 0.25 255 0 1\n1\n1\n" + kIdentity + "7 8 9 1\n";
    Random random(5);
    for (int i = 0; i < 6000; ++i) {
        std::string text = seed;
        for (uint64_t k = 0; k <= random.next() % 4; ++k)
            text[random.next() % text.size()] = random.next() % 2 ? "0123456789.- \n\re"[random.next() % 16]
                                                                  : static_cast<char>(random.next());
        for (const bool salvage : {false, true}) {
            const auto error = error_of(text, {"", true, {}, salvage});  // or none
            EXPECT_TRUE(error.why.empty() || error.kind == ErrorKind::input_rejected) << text;
        }
    }
}

}  // namespace
}  // namespace lucarne::io
