// COPC files as octrees: real ones, and what lies in them.
#include "io/formats/copc.h"

#include <numeric>

#include <gmock/gmock.h>

#include "io/formats/scan.h"
#include "octree/attributes.h"
#include "octree/open.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using test::TempFolder;
using ::testing::HasSubstr;

class SharedCopc : public ::testing::TestWithParam<const char*> {
 protected:
    void SetUp() override {
        if (io::testing::shared_data().empty()) GTEST_SKIP() << "the shared data is not here";
    }
    const std::filesystem::path path_ =
        io::testing::shared_data() / "las" / (std::string(GetParam()) + ".copc.laz");
};

TEST_P(SharedCopc, AllPointsOfAllNodesAreThoseThatTheLazReaderGives) {
    ASSERT_TRUE(is_octree(path_));
    const auto copc = open_octree(path_);
    ASSERT_TRUE(copc) << copc.error().line();
    const auto laz = io::open_scan(path_);
    ASSERT_TRUE(laz) << laz.error().line();
    const uint32_t stride = (*laz)->schema().stride;
    EXPECT_EQ((*copc)->header().points, (*laz)->info().declared_points);
    EXPECT_EQ((*copc)->header().schema.scale, (*laz)->schema().scale);
    EXPECT_TRUE(test::sorted_records(**copc, stride) == test::sorted_records(**laz, stride));
}

TEST_P(SharedCopc, EveryPointIsInItsNodesCubeAndTheNodesAreATree) {
    const auto copc = open_octree(path_);
    ASSERT_TRUE(copc) << copc.error().line();
    const auto nodes = (*copc)->nodes();
    const SourceHeader& header = (*copc)->header();
    for (uint32_t i = 0; i < nodes.size(); ++i) {
        uint64_t below = nodes[i].count;
        for (uint32_t octant = 0; octant < 8; ++octant)
            if (const uint32_t child = nodes[i].child(octant); child != kNoNode) {
                EXPECT_EQ(nodes[child].parent, i);
                EXPECT_EQ(nodes[child].key, nodes[i].key.child(octant));
                below += nodes[child].subtree_count;
            }
        EXPECT_EQ(nodes[i].subtree_count, below);
        const Cube cube = (*copc)->cube(i);
        const double slack = 0.501 * header.schema.scale.x + 1e-9 * header.root.size;  // quantised after
        const auto data = (*copc)->load(i);
        ASSERT_TRUE(data) << data.error().line();
        for (uint32_t p = 0; p < data->count; ++p) {
            const auto at = io::position_of(header.schema, &data->records[p * header.schema.stride]);
            for (int axis = 0; axis < 3; ++axis) {
                ASSERT_GE(at[axis], cube.min[axis] - slack);
                ASSERT_LE(at[axis], cube.min[axis] + cube.size + slack);
                ASSERT_GE(at[axis], header.min[axis] - slack);
                ASSERT_LE(at[axis], header.max[axis] + slack);
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All, SharedCopc,
                         ::testing::Values("1.2-with-color", "lone-star", "statue_lion_takanawa"),
                         [](const auto& file) {
                             std::string name;
                             for (const char c : std::string(file.param))
                                 if (std::isalnum(static_cast<unsigned char>(c))) name += c;
                             return name;
                         });

}  // namespace
}  // namespace lucarne::octree
