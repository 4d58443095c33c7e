// Runs of a scan that is read in parts.
#include "octree/stations/scan_runs.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace lucarne::octree {
namespace {

/// Adds the points [first, end) of a scan, some at a time.
void add(ScanRuns& runs, const std::vector<glm::dvec3>& points, uint64_t first, uint64_t end) {
    constexpr uint64_t kBatch = 1000;
    for (; first < end; first += std::min(kBatch, end - first))
        runs.add(io::Schema{},
                 std::as_bytes(std::span(points).subspan(first, std::min(kBatch, end - first))));
}

TEST(ScanRuns, OfPartsAreThoseOfTheWholeScan) {
    constexpr uint64_t kFull = ScanRuns::kRunPoints * ScanRuns::kMostRuns;
    for (const uint64_t count : {uint64_t{3}, uint64_t{640}, kFull - 1, kFull, kFull + 1, 2 * kFull - 63,
                                 2 * kFull - 64, 2 * kFull, 5 * kFull + 7}) {
        std::vector<glm::dvec3> points;
        for (uint64_t i = 0; i < count; ++i) points.emplace_back(1e6 + static_cast<double>(i) / 3, i % 7, 0);
        ScanRuns whole;
        add(whole, points, 0, count);
        for (const uint64_t parts : {2, 3, 7}) {
            ScanRuns joined;
            for (uint64_t part = 0; part < parts; ++part) {
                const uint64_t first = part * count / parts, end = (part + 1) * count / parts;
                ScanRuns runs(first, count, points[0]);
                add(runs, points, first, end);
                if (part == 0)
                    joined = runs;
                else
                    joined.join(runs.kept(), end - first);
            }
            EXPECT_TRUE(std::ranges::equal(joined.kept(), whole.kept())) << count << " in " << parts;
            EXPECT_EQ(joined.points(), whole.points());
            EXPECT_EQ(joined.first_point(1), whole.first_point(1)) << count;
            EXPECT_EQ(joined.origin(), whole.origin());
        }
    }
}

}  // namespace
}  // namespace lucarne::octree
