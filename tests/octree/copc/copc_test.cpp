// COPC files as octrees: real ones, and ones with false contents.
#include "octree/copc/copc.h"

#include <atomic>
#include <cmath>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "io/formats/scan.h"
#include "octree/convert/build.h"
#include "octree/export/export.h"
#include "octree/open.h"
#include "octree/tree/attributes.h"
#include "tests/octree/test_sources.h"

namespace lucarne::octree {
namespace {

using test::TempFolder;

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
        // Files are quantised after they are divided.
        const double slack = 0.501 * header.schema.scale.x + 1e-9 * header.root.size;
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

/// A level square of 10 units of random points, built and written as COPC.
class CopcSquare : public ::testing::Test {
 protected:
    void SetUp() override {
        io::Schema schema;
        schema.position = io::PositionType::i32_scaled;
        schema.scale = glm::dvec3(1e-4);
        schema.stride = 12;
        const test::ComputedSource square(schema, 200'000, [](uint64_t index, std::byte* record) {
            Random random(3, index);
            io::store(record, static_cast<int32_t>(1e5 * random.uniform()));
            io::store(record + 4, static_cast<int32_t>(1e5 * random.uniform()));
            io::store(record + 8, int32_t{7});
        });
        ASSERT_TRUE(
            build_cache({.inputs = {&square}, .output = folder_ / "a.luc", .normals = NormalsMode::none}));
        const auto cache = open_octree(folder_ / "a.luc");
        ASSERT_TRUE(Exporter(**cache, {}).write_copc(folder_ / "a.copc.laz", false, [](uint64_t) {}));
        auto copc = open_octree(folder_ / "a.copc.laz");
        ASSERT_TRUE(copc) << copc.error().line();
        copc_ = std::move(*copc);
    }
    const TempFolder folder_;
    std::unique_ptr<NodeSource> copc_;
};

TEST_F(CopcSquare, ItsNormalsPointUp) {
    const io::Schema& schema = copc_->header().schema;
    const io::Attribute* normal = schema.find(io::names::normal_oct);
    ASSERT_TRUE(normal);
    for (uint32_t node = 0; node < copc_->nodes().size(); ++node) {
        const auto data = copc_->load(node);
        ASSERT_TRUE(data) << data.error().line();
        for (size_t i = 0; i < data->count; ++i) {
            const auto n =
                decode_normal(io::load<NormalCode>(&data->records[i * schema.stride + normal->offset]));
            ASSERT_TRUE(n && n->z > 0.999f) << "node " << node;
        }
    }
}

TEST_F(CopcSquare, ItsFloorsAddUpToItsSurfaceAtEveryLevel) {
    const auto nodes = copc_->nodes();
    const uint32_t deepest = nodes.back().key.level;
    ASSERT_GE(deepest, 2u);
    for (uint32_t level = 0; level <= deepest; ++level) {
        // A point's area is the floor of the deepest node around it, down to this level. The points of a node
        // and its ancestors are as dense as its floor says, so the node's surface is its own points' share of
        // that.
        double covered = 0;
        for (const NodeInfo& node : nodes) {
            if (node.key.level > level || (node.child_mask && node.key.level < level)) continue;
            const double own = 1 / node.area_floor[0],
                         above = node.parent == kNoNode ? 0.0 : 1 / nodes[node.parent].area_floor[0];
            covered += node.count / (own - above);
        }
        EXPECT_NEAR(covered, 100.0, 20.0) << "level " << level;
    }
    for (const NodeInfo& node : nodes)
        for (size_t step = 1; step < kPrefixSteps; ++step)
            EXPECT_GE(node.area_floor[step], node.area_floor[step - 1]);
}

/// Counts the bytes that are read of a file.
class CountedFile final : public ByteSource {
 public:
    explicit CountedFile(InputFile file)
        : ByteSource(file.path(), file.size(), file.modified()), file_(std::move(file)) {}
    Result<size_t> read_some(uint64_t offset, std::span<std::byte> out) const override {
        bytes_ += out.size();
        return file_.read_some(offset, out);
    }
    uint64_t bytes() const { return bytes_; }

 private:
    InputFile file_;
    mutable std::atomic<uint64_t> bytes_{0};
};

TEST_F(CopcSquare, ANodeThatIsLoadedAgainIsNotReadAgain) {
    auto file = InputFile::open(folder_ / "a.copc.laz");
    ASSERT_TRUE(file);
    const auto counted = std::make_shared<const CountedFile>(std::move(*file));
    auto copc = open_copc(counted);
    ASSERT_TRUE(copc) << copc.error().line();
    std::vector<NodeData> first;
    for (uint32_t node = 0; node < (*copc)->nodes().size(); ++node) {
        auto data = (*copc)->load(node);
        ASSERT_TRUE(data) << data.error().line();
        first.push_back(std::move(*data));
    }
    const uint64_t read = counted->bytes();
    EXPECT_GT(read, counted->size() / 2);
    for (uint32_t node = 0; node < first.size(); ++node) {
        const auto data = (*copc)->load(node);
        ASSERT_TRUE(data);
        EXPECT_EQ(data->count, first[node].count);
        EXPECT_EQ(data->records, first[node].records);
    }
    EXPECT_EQ(counted->bytes(), read);
}

TEST_F(CopcSquare, EveryPrefixOfANodeIsEven) {
    const io::Schema& schema = copc_->header().schema;
    const auto data = copc_->load(0);
    ASSERT_TRUE(data) << data.error().line();
    for (const size_t part : {4, 16, 64}) {
        std::vector<glm::dvec3> points;
        for (size_t i = 0; i < data->count / part; ++i)
            points.push_back(io::position_of(schema, &data->records[i * schema.stride]));
        double nearest = 1e9;
        for (size_t i = 0; i < points.size(); ++i)
            for (size_t j = 0; j < i; ++j) nearest = std::min(nearest, glm::distance(points[i], points[j]));
        const double spacing = std::sqrt(100.0 / static_cast<double>(points.size()));
        EXPECT_GT(nearest, 0.4 * spacing) << points.size() << " of " << data->count;
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
