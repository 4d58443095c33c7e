// Synthetic surfels in cuts.
#include "octree/tree/filling.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "gi/surfels/surfel_pool.h"
#include "octree/tree/attributes.h"
#include "tests/gi/engines/surfel_cloud.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

constexpr double kShare = 0.0025;  // m^2

/// 40 x 40 surfels of a square of 2 m at z = 1, red.
octree::Filling square() {
    octree::SourceHeader header;
    header.root = {{-8, -8, -8}, 16};
    header.filling = octree::FillingSection{.schema = octree::filling_schema(header.root), .points = 1600};
    const io::Schema& schema = header.filling->schema;
    octree::NodeData data{1600, std::vector<std::byte>(1600 * schema.stride)};
    for (int i = 0; i < 1600; ++i) {
        std::byte* record = &data.records[static_cast<size_t>(i) * schema.stride];
        const glm::dvec3 place(0.05 * (i % 40) + 0.025, 0.05 * (i / 40) + 0.025, 1);
        for (int axis = 0; axis < 3; ++axis)
            io::store(record + 4 * axis,
                      static_cast<int32_t>((place[axis] - schema.offset[axis]) / schema.scale[axis]));
        io::store(record + schema.find(io::names::color)->offset, uint8_t{255});
        io::store(record + schema.find(io::names::normal_oct)->offset, octree::encode_normal({0, 0, 1}));
        io::store(record + schema.find(io::names::area)->offset, octree::encode_area(kShare, 16));
    }
    return octree::grouped_filling(header, data);
}

class FilledCut : public OnDevice {};

TEST_F(FilledCut, HasTheSurfelsButNoPointsForThem) {
    const SurfelCloud cloud({{{0, 0, 0}, {0, 0, 1}, glm::vec3(0.5f), 0, 0.01f, 0}});
    const std::vector<octree::Filling> fillings{square()};
    ASSERT_EQ(fillings[0].nodes.size(), 1u);
    auto pool = SurfelPool::create(*device, 4 * SurfelPool::kPageSurfels).value();
    ASSERT_TRUE(pool.load(0, cloud.packed(0)).value());
    Scene scene;
    scene.materials.resize(1);
    ASSERT_TRUE(pool.load(kFirstFilled, pack_surfels(fillings[0].header, fillings[0].nodes[0],
                                                     fillings[0].records[0], scene))
                    .value());
    DeviceCut open, filled, clipped;
    ASSERT_TRUE(pool.make_cut(*device, cloud, cloud.whole(), glm::dvec3(0.0), open));
    ASSERT_TRUE(pool.make_cut(*device, cloud, cloud.whole(), glm::dvec3(0.0), filled, {}, fillings));
    EXPECT_EQ(open.surfels(), 1u);
    EXPECT_EQ(filled.surfels(), 1u) << "synthetic surfels are no points";
    EXPECT_NE(open.fingerprint(), filled.fingerprint());
    EXPECT_EQ(node_changes(open.nodes(), filled.nodes()).added, std::vector<uint32_t>{kFirstFilled});
    const std::vector<Surfel> surfels = pool.download(filled);
    ASSERT_EQ(surfels.size(), 1601u);
    for (size_t i = 1; i < surfels.size(); ++i) {
        EXPECT_NEAR(surfels[i].position.z, 1, 1e-3);
        EXPECT_NEAR(surfels[i].area, kShare, 0.05 * kShare);
        EXPECT_NEAR(surfels[i].radius, std::sqrt(7 * kShare / 3.14159), 0.03 * std::sqrt(kShare));
        EXPECT_GT(surfels[i].normal.z, 0.999f);
        EXPECT_GT(surfels[i].albedo.x, 0.9f);
        EXPECT_LT(surfels[i].albedo.y, 0.01f);
    }
    // Picking: ids of the filling are no points.
    EXPECT_TRUE(filled.points()->find(0));
    for (uint32_t id = 1; id < filled.blocks() * kBlockSurfels; ++id)
        ASSERT_FALSE(filled.points()->find(id)) << id;
    // The scene's clip cuts them off like points.
    Clip clip;
    clip.planes.push_back({.position = {1, 0, 0}, .normal = {1, 0, 0}});
    ASSERT_TRUE(pool.make_cut(*device, cloud, cloud.whole(), glm::dvec3(0.0), clipped, clip, fillings));
    EXPECT_EQ(pool.download(clipped).size(), 800u);
}

/// Far from each other, fillings are divided into cubes that resolve their spacing.
TEST(FillingCubes, AreFineEnough) {
    octree::SourceHeader header;
    header.root = {glm::dvec3(0.0), 100000};
    header.filling = octree::FillingSection{.schema = octree::filling_schema(header.root), .points = 2000};
    const io::Schema& schema = header.filling->schema;
    octree::NodeData data{2000, std::vector<std::byte>(2000 * schema.stride)};
    for (size_t i = 0; i < 2000; ++i) {
        std::byte* record = &data.records[i * schema.stride];
        for (size_t axis = 0; axis < 3; ++axis)
            io::store(record + 4 * axis,
                      static_cast<int32_t>((i < 1000 ? -2e9 : 2e9) + 1000.0 * static_cast<double>(i)));
        io::store(record + schema.find(io::names::area)->offset,
                  octree::encode_area(kShare, header.root.size));
    }
    const octree::Filling filling = octree::grouped_filling(header, data);
    EXPECT_GE(filling.nodes.size(), 2u);
    EXPECT_LE(filling.nodes.size(), 256u);
    uint64_t count = 0;
    for (const auto& node : filling.nodes) count += node.count;
    EXPECT_EQ(count, 2000u);
    EXPECT_LE(header.root.of(filling.nodes[0].key).size, 4096 * std::sqrt(kShare) * 2);
}

}  // namespace
}  // namespace lucarne::gi
