// Parts of text files can be read without the rows before them, and together hold every row once.
#include <algorithm>

#include <fmt/format.h>

#include "io/core/random.h"
#include "tests/io/formats/scan_text.h"

namespace lucarne::io {
namespace {

class RowFronts : public testing::TextScan {
 protected:
    /// Checks the parts of the file that was read against the whole pass.
    void check(size_t least_parts) {
        ASSERT_GE(source_->parts(), least_parts);
        std::vector<std::byte> all;
        PointBatch batch, first;
        for (size_t part = 0; part < source_->parts(); ++part) {
            ASSERT_TRUE(source_->front(part, SIZE_MAX, batch));
            ASSERT_EQ(batch.bytes.size(), batch.count * schema().stride);
            all.insert(all.end(), batch.bytes.begin(), batch.bytes.end());
            ASSERT_TRUE(source_->front(part, 3, first));
            ASSERT_EQ(first.count, std::min<size_t>(3, batch.count));
            EXPECT_TRUE(std::equal(first.bytes.begin(), first.bytes.end(), batch.bytes.begin()));
        }
        EXPECT_TRUE(all == records_.bytes) << all.size() / schema().stride << " of " << points();
    }
};

/// Rows of random length, each with an end.
std::string rows_of(size_t count, std::string_view columns, std::string_view end, uint64_t seed) {
    Random random(seed);
    std::string text;
    for (size_t i = 0; i < count; ++i) {
        const int digits = static_cast<int>(random.next() % 9);
        text += fmt::format("{:.{}f}{}{:.{}f}{}{:.3f}", 100 * random.uniform(), digits, columns,
                            -random.uniform(), 9 - digits, columns, random.uniform());
        text += end;
        if (i % 1000 == 7) text += fmt::format("# a comment{}{}", end, end);
    }
    return text;
}

TEST_F(RowFronts, TogetherHoldEveryRowOnce) {
    for (const std::string_view end : {"\n", "\r\n", "\r"}) {
        std::string text = rows_of(20'000, " ", end, 1);
        read(text);
        check(5);
        text.resize(text.size() - end.size());  // the last row lacks its end
        read(text);
        ASSERT_EQ(points(), 20'000u);
        check(5);
    }
}

TEST_F(RowFronts, UnderstandDecimalCommasAndCounts) {
    std::string text = rows_of(10'000, ";", "\n", 2);
    std::ranges::replace(text, '.', ',');
    read(text);
    ASSERT_EQ(points(), 10'000u);
    check(3);
    read("6000\n" + rows_of(6'000, " ", "\n", 3) + "4000\n" + rows_of(4'000, " ", "\n", 4));
    ASSERT_EQ(points(), 10'000u);
    check(3);
}

TEST_F(RowFronts, PlaceEveryScanOfAPtxByItsPose) {
    std::string text;
    for (int scan = 0; scan < 4; ++scan) {
        const int rows = scan == 1 ? 2 : 8'000;
        text += fmt::format("1\n{}\n{} 5 6\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n{} 5 6 1\n", rows,
                            scan, scan);
        for (int i = 0; i < rows; ++i)
            text += i % 10 == 3 ? "0 0 0 0.5\n" : fmt::format("{:.4f} {} 3.5 0.25\n", i / 7.0, scan);
    }
    read(text);
    ASSERT_EQ(points(), 3 * 7'200u + 2);
    check(7);
}

TEST_F(RowFronts, OfAsciiPcd) {
    read(
        "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 9000\nHEIGHT 1\nPOINTS "
        "9000\nDATA ascii\n" +
        rows_of(9'000, " ", "\n", 5));
    ASSERT_EQ(points(), 9'000u);
    check(3);
}

TEST_F(RowFronts, SkipWhatDoesNotFitAndRowsWithoutEnd) {
    std::string text = rows_of(5'000, " ", "\n", 6);
    for (size_t at = text.size() / 2; at < text.size(); ++at)
        if (text[at] == '\n' && at > text.size() * 3 / 4) text[at] = 'x';
    ASSERT_FALSE(error_of(text).why.empty());
    ASSERT_TRUE(source_);
    PointBatch batch;
    size_t rows = 0;
    for (size_t part = 0; part < source_->parts(); ++part) {
        ASSERT_TRUE(source_->front(part, SIZE_MAX, batch));
        rows += batch.count;
    }
    EXPECT_GT(rows, 3'000u);
    EXPECT_LT(rows, 3'800u);
}

}  // namespace
}  // namespace lucarne::io
