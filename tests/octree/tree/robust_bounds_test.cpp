#include "octree/tree/robust_bounds.h"

#include <cmath>
#include <functional>

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "octree/cache/cache.h"
#include "octree/convert/build.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using lucarne::test::ComputedSource;
using lucarne::test::TempFolder;

/// A room of 8 x 8 x 3, with one of `every` points up to `far` away; 0: none.
std::array<glm::dvec3, 2> bounds_with_outliers(uint64_t points, uint64_t every, double far = 1000) {
    const TempFolder folder;
    const ComputedSource source(io::Schema{}, points, [every, far](uint64_t index, std::byte* record) {
        Random random(7, index);
        glm::dvec3 p(8 * random.uniform(), 8 * random.uniform(), index % 2 ? 0 : 3);
        if (every && index % every == 0)
            p = far * glm::dvec3(random.uniform() - .5, random.uniform() - .5, random.uniform());
        io::store(record, p);
    });
    BuildOptions options;
    options.inputs = {&source};
    options.output = folder / "a.luc";
    options.normals = NormalsMode::none;
    EXPECT_TRUE(build_cache(options));
    const auto cache = open_cache(options.output);
    return robust_bounds(**cache);
}

TEST(RobustBounds, IsTheRoomWhereAFewPointsAreFarAway) {
    const auto [low, high] = bounds_with_outliers(200'000, 1000);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(low[axis], 0.1);
        EXPECT_GE(low[axis], -10);
        EXPECT_GE(high[axis], axis == 2 ? 2.9 : 7.9);
        EXPECT_LE(high[axis], 20);
    }
}

TEST(RobustBounds, IsEverythingWhereNothingStraysOrTooManyDo) {
    const auto [low, high] = bounds_with_outliers(100'000, 0);
    EXPECT_NEAR(high.x - low.x, 8, .01);
    EXPECT_NEAR(high.z - low.z, 3, .01);
    const auto scattered = bounds_with_outliers(300'000, 3);
    EXPECT_GT(scattered[1].x - scattered[0].x, 900);
}

TEST(RobustBounds, IsEverythingWhereItsPointsWouldFallIntoOnePlaceOfTheirNode) {
    const auto [low, high] = bounds_with_outliers(9'999, 0);
    EXPECT_LT(high.x - low.x, 9);
    const auto far =
        bounds_with_outliers(10'001, 10'000, 1e9);  // the room is one leaf, half as wide as the whole cloud
    EXPECT_GT(far[1].x - far[0].x, 1e6);
}

TEST(RobustBounds, OfOnePointIsThatPoint) {
    const auto [low, high] = bounds_with_outliers(1, 0);
    EXPECT_EQ(low, high);
}

/// One node of 64 points between 0 and 63; all of `damaged` have no coordinates.
class Damaged : public NodeSource {
 public:
    explicit Damaged(const std::function<bool(uint32_t)>& damaged) : nodes_(1) {
        header_.root = {glm::dvec3(0.0), 64};
        header_.max = glm::dvec3(63);
        header_.points = nodes_[0].count = data_.count = 64;
        nodes_[0].subtree_count = 64;
        data_.records.resize(size_t{64} * header_.schema.stride);
        for (uint32_t i = 0; i < 64; ++i)
            io::store(&data_.records[size_t{i} * header_.schema.stride],
                      glm::dvec3(damaged(i) ? std::nan("") : 63.0 - i));
    }
    const SourceHeader& header() const override { return header_; }
    NodeTable nodes() const override { return nodes_; }
    Result<NodeData> load(uint32_t) const override { return data_; }

 private:
    SourceHeader header_;
    std::vector<NodeInfo> nodes_;
    NodeData data_;
};

TEST(RobustBounds, CoordinatesThatAreNoNumbersStandForTheirCube) {
    for (const uint32_t every : {1u, 2u, 5u}) {
        const auto [low, high] = robust_bounds(Damaged([every](uint32_t i) { return i % every == 0; }));
        EXPECT_EQ(low, glm::dvec3(0.0)) << every;
        EXPECT_EQ(high, glm::dvec3(63.0)) << every;
    }
}

}  // namespace
}  // namespace lucarne::octree
