// LAS and LAZ files that are read in parts.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "io/formats/common/divisible.h"
#include "io/formats/scan.h"
#include "io/synthetic/synthetic.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using Bytes = std::vector<std::byte>;

class ReadInParts : public ::testing::TestWithParam<std::string> {
 protected:
    void SetUp() override {
        const auto rooms = synthetic_source({.scene = "two-rooms", .points = 160'000});
        ASSERT_TRUE(rooms);
        const auto path = folder_ / ("a" + GetParam());
        auto writer = create_scan(path, (*rooms)->schema(), (*rooms)->info(), {});
        ASSERT_TRUE(writer) << writer.error().line();
        const auto reader = (*rooms)->open();
        PointBatch batch;
        while ((*reader)->read(batch, 10'000).value() > 0) ASSERT_TRUE((*writer)->write(batch.bytes));
        ASSERT_TRUE((*writer)->finish());
        auto scan = open_scan(path, {});
        ASSERT_TRUE(scan) << scan.error().line();
        scan_ = std::move(*scan);
        divisible_ = dynamic_cast<const DivisibleSource*>(scan_.get());
        ASSERT_NE(divisible_, nullptr);
    }
    static Bytes all_of(PointReader& reader) {
        Bytes all;
        PointBatch batch;
        while (reader.read(batch, 7'777).value() > 0)
            all.insert(all.end(), batch.bytes.begin(), batch.bytes.end());
        return all;
    }
    testing::TemporaryFolder folder_;
    std::unique_ptr<PointSource> scan_;
    const DivisibleSource* divisible_ = nullptr;
};

TEST_P(ReadInParts, GivesThePointsOfOnePass) {
    const uint64_t count = scan_->info().declared_points;
    const Bytes whole = all_of(**scan_->open());
    ASSERT_EQ(whole.size(), count * scan_->schema().stride);
    for (const uint64_t parts : {1, 2, 3, 7}) {
        Bytes all;
        uint64_t first = 0;
        for (uint64_t part = 1; part <= parts; ++part) {
            const uint64_t end = part == parts ? count : divisible_->cut(part * count / parts).value();
            ASSERT_GE(end, first);
            EXPECT_LE(end, part * count / parts);
            EXPECT_EQ(divisible_->cut(end).value(), end);
            auto reader = divisible_->open_part(first, end);
            ASSERT_TRUE(reader) << reader.error().line();
            const Bytes some = all_of(**reader);
            EXPECT_EQ(some.size(), (end - first) * scan_->schema().stride);
            all.insert(all.end(), some.begin(), some.end());
            first = end;
        }
        EXPECT_TRUE(all == whole) << parts;
    }
    EXPECT_GT(divisible_->cut(count / 2).value(), 0u);
}

TEST_P(ReadInParts, RefusesPlacesThatAreNone) {
    const uint64_t count = scan_->info().declared_points;
    EXPECT_FALSE(divisible_->open_part(count / 2, count / 3));
    if (divisible_->cut(1).value() == 0) {
        EXPECT_FALSE(divisible_->open_part(1, count));
        EXPECT_FALSE(divisible_->open_part(0, 1));
    }
    EXPECT_EQ(divisible_->cut(count + 5).value(), count);
}

INSTANTIATE_TEST_SUITE_P(All, ReadInParts, ::testing::Values(".las", ".laz"),
                         [](const auto& which) { return which.param.substr(1); });

}  // namespace
}  // namespace lucarne::io
