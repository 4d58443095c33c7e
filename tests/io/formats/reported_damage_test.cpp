// Files made after public reports: headers that lie about what follows them, parts that are missing, bodies
// that do not fit their header.
#include <algorithm>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <gmock/gmock.h>

#include "tests/io/formats/las/las_builder.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using ::testing::HasSubstr;
using testing::read_all;

class ReportedDamage : public ::testing::Test {
 protected:
    void SetUp() override {
        if (!std::filesystem::exists(folder_)) GTEST_SKIP() << "the shared reports are not here";
    }
    /// What a pass over a file returns, and what it says.
    struct Seen {
        uint64_t points = 0;
        Contents contents;
        std::string said, error;
        std::vector<glm::dvec3> positions;
    };
    Seen see(const std::string& file, bool salvage) const {
        Seen seen;
        ::testing::internal::CaptureStderr();
        const auto done = pass(file, {"", false, {0, 0, true}, salvage}, seen);
        seen.said = ::testing::internal::GetCapturedStderr();
        if (!done) seen.error = done.error().line();
        return seen;
    }
    const std::filesystem::path folder_ = testing::shared_data() / "reports";

 private:
    Result<void> pass(const std::string& file, const ReadOptions& options, Seen& seen) const {
        LUCARNE_ASSIGN(const auto source, open_scan(folder_ / file, options));
        LUCARNE_ASSIGN(const auto records, read_all(*source));
        LUCARNE_ASSIGN(seen.contents, survey(*source));
        seen.points = records.count;
        const Schema& schema = source->schema();
        for (size_t i = 0; i < records.count; ++i)
            seen.positions.push_back(position_of(schema, &records.bytes[i * schema.stride]));
        return {};
    }
};

TEST_F(ReportedDamage, ASecondScanOfPtxThatComesEarlyKeepsItsOwnPlace) {
    EXPECT_THAT(see("lie_more_then_second.ptx", false).error, HasSubstr("the next scan begins at line 611"));
    const Seen saved = see("lie_more_then_second.ptx", true);
    EXPECT_EQ(saved.points, 480u + 61);
    const glm::dvec3 p(-2.604822, -4.865452, -3.053169);  // the first point of the second scan
    const glm::dvec3 placed = glm::dmat3(.453596, .891207, 0, -.891207, .453596, 0, 0, 0, 1) * p;
    ASSERT_EQ(saved.positions.size(), 541u);
    EXPECT_LT(glm::distance(saved.positions[480], placed + glm::dvec3(105, 190, 3.5)), 1e-9);
}

TEST_F(ReportedDamage, LazGivesAsManyPointsAsItsHeaderCountsOrWithSalvageAsItsChunksHold) {
    const Seen few = see("ok3_count_less.laz", false), all = see("ok3_count_less.laz", true);
    EXPECT_EQ(few.error, "");
    EXPECT_EQ(few.points, 119'989u);
    EXPECT_EQ(few.contents.losses, (Losses{{std::string(lost::uncounted), 11}}));
    EXPECT_EQ(all.points, 120'000u);
    EXPECT_TRUE(all.contents.losses.empty());

    EXPECT_THAT(see("ok3_count_more.laz", false).error, HasSubstr("cut off or damaged"));
    const Seen more = see("ok3_count_more.laz", true);
    EXPECT_EQ(more.points, 120'000u);
    EXPECT_EQ(more.contents.losses, (Losses{{std::string(lost::cut_off), 15}}));
    EXPECT_EQ(more.positions, all.positions);
}

TEST_F(ReportedDamage, LasWhoseHeaderCountsNothingIsReadWithSalvage) {
    const Seen seen = see("count_zero_but_points.las", false);
    EXPECT_EQ(seen.points, 0u);
    EXPECT_THAT(seen.said, HasSubstr("600 records take as many, and --salvage reads them"));
    EXPECT_EQ(see("count_zero_but_points.las", true).points, 600u);
}

TEST_F(ReportedDamage, Las15IsRead) {
    const Seen seen = see("v15.las", false);
    EXPECT_EQ(seen.error, "");
    EXPECT_EQ(seen.points, 600u);
}

TEST_F(ReportedDamage, AnE57ThatLacksItsLastByteIsReadWithSalvage) {
    EXPECT_THAT(see("last_byte_missing.e57", false).error, HasSubstr("is truncated"));
    const Seen saved = see("last_byte_missing.e57", true);
    EXPECT_EQ(saved.error, "");
    EXPECT_EQ(saved.points, 500u);
}

TEST_F(ReportedDamage, PointsOfE57AtTheScannerAreLeftOut) {
    const Seen seen = see("zeros_unflagged.e57", false);
    EXPECT_EQ(std::ranges::count(seen.positions, glm::dvec3(0.0)), 0);
    ASSERT_EQ(seen.contents.losses.size(), 1u);
    EXPECT_EQ(seen.points + seen.contents.losses[0].count, 500u);
}

TEST_F(ReportedDamage, WholeNumbersInE57MayBeMillimetres) {
    const Seen seen = see("mm_integers.e57", false);
    EXPECT_EQ(seen.points, 200u);
    EXPECT_THAT(seen.said, HasSubstr("--unit mm"));
}

TEST_F(ReportedDamage, HeaderLinesOfPlyMayEndInLineFeedAndCarriageReturn) {
    const Seen seen = see("lfcr.ply", false);
    EXPECT_EQ(seen.points, 300u);
    EXPECT_EQ(seen.said, "");
    for (const glm::dvec3& at : seen.positions) EXPECT_LT(glm::length(at), 100);
}

TEST_F(ReportedDamage, CoordinatesThatAreNoMapsNameARemedy) {
    EXPECT_THAT(see("ecef.las", false).said, HasSubstr("EPSG:32631"));
    EXPECT_THAT(see("ll_no_crs.las", false).said, HasSubstr("EPSG:32610"));
}

TEST_F(ReportedDamage, AViewpointOfFourNumbersIsRefused) {
    EXPECT_THAT(see("extended.pcd", false).error, HasSubstr("has a VIEWPOINT without seven numbers"));
}

TEST_F(ReportedDamage, ChunksOfAnySizeTellTheirNumberOfPoints) {
    const std::string bytes = testing::read_bytes(folder_ / "copc_vlr_chunk0.copc.laz");
    const testing::TemporaryFolder folder;
    for (const uint64_t count : {uint64_t{0}, uint64_t{1060}, uint64_t{3}, uint64_t{1066}, uint64_t{5000}}) {
        std::string changed = bytes;
        testing::put(changed, 247, count);
        testing::put(changed, 107, uint32_t{0});
        testing::write_bytes(folder / fmt::format("{}.laz", count), changed);
        for (const bool salvage : {false, true}) {
            const auto source = open_scan(folder / fmt::format("{}.laz", count), {"", true, {}, salvage});
            EXPECT_EQ(source.has_value(), salvage || count < 1065) << count;
            if (!source) continue;
            const auto records = read_all(**source);
            ASSERT_TRUE(records) << records.error().line();
            EXPECT_EQ(records->count, salvage ? 1065u : count);
        }
    }
}

TEST_F(ReportedDamage, EveryReportIsReadOrRejectedWhateverItsHeaderCounts) {
    const testing::MemoryFile file;
    size_t tried = 0;
    for (const char* folder : {"reports", "bad"})
        for (const auto& entry : std::filesystem::directory_iterator(testing::shared_data() / folder)) {
            if (!entry.is_regular_file() || entry.file_size() > 20'000) continue;
            const std::string bytes = testing::read_bytes(entry.path());
            for (size_t at = 0; at + 8 < std::min<size_t>(bytes.size(), 400); at += 7)
                for (const uint64_t value : {uint64_t{1} << 63, UINT64_MAX}) {
                    std::string changed = bytes;
                    if (at > 0) testing::put(changed, at, value);
                    file.set(changed);
                    for (const bool salvage : {false, true}) {
                        const auto source = open_scan(file.path(), {"", true, {0, 100, false}, salvage});
                        Result<std::unique_ptr<PointReader>> reader;
                        if (source) reader = (*source)->open();
                        PointBatch batch;
                        if (source && reader) (void)(*reader)->read(batch, 1000);
                        EXPECT_TRUE(source || source.error().kind != ErrorKind::arguments) << entry.path();
                        ++tried;
                    }
                }
        }
    EXPECT_GT(tried, 1000u);
}

TEST_F(ReportedDamage, CopcMayStateNoSizeOfItsChunks) {
    const Seen seen = see("copc_vlr_chunk0.copc.laz", false);
    EXPECT_EQ(seen.error, "");
    EXPECT_EQ(seen.points, 1065u);
}

}  // namespace
}  // namespace lucarne::io
