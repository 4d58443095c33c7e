// A cut that is loaded on the host against the same cut on the device.
#include "gi/bake/host_cut.h"

#include <gtest/gtest.h>

#include "tests/viewer/frame/with_cornell.h"
#include "viewer/frame/surfel_stream.h"

namespace lucarne::viewer {
namespace {

class HostCutTest : public test::WithCornell {
 protected:
    void SetUp() override {
        WithCornell::SetUp();
        if (HasFatalFailure()) return;
        frame_ = gi::local_frame(source_->header().min, source_->header().metres_per_unit);
        scene_ = gi::default_scene(source_->header().min, source_->header().max);
    }
    Result<gi::HostCut> on_host(uint64_t points, const gi::Clip& clip = {},
                                std::span<const octree::Filling> fillings = {}) const {
        return gi::load_host_cut(*source_, cut(points), frame_, gi::SurfelPreparation(source_, scene_), clip,
                                 fillings);
    }
    octree::Cut cut(uint64_t points) const {
        return octree::light_cut(*source_, source_->header().max, points);
    }
    gi::LocalFrame frame_;
    gi::Scene scene_;
};

TEST_F(HostCutTest, HasTheSurfelsThatTheDeviceHas) {
    gi::Clip clip;
    clip.boxes = {{source_->header().min, (source_->header().min + source_->header().max) / 2.0}};
    int filled = 0;
    for (const uint64_t points : {uint64_t{500}, uint64_t{5'000}, uint64_t{30'000}, uint64_t{1'000'000}})
        for (const gi::Clip& used : {gi::Clip{}, clip}) {
            DeviceCuts cuts;
            SurfelStream stream(*device_, {uint64_t{64} << 20, uint64_t{256} << 20, 1}, cuts);
            ASSERT_TRUE(stream.set_source(source_, scene_));
            ASSERT_TRUE(stream.renew(scene_));
            const octree::Cut chosen = cut(points);
            ASSERT_TRUE(stream.load_all({&chosen}));
            std::vector<gi::CutEntry> entries;
            for (const auto& node : chosen.nodes) entries.push_back({node.node, node.count});
            gi::DeviceCut made;
            const auto fillings = gi::fillings_of(stream.fillings(), chosen.points);
            filled += !fillings.empty();
            ASSERT_TRUE(
                stream.pool().make_cut(*device_, *source_, entries, frame_.origin, made, used, fillings));
            const auto expected = stream.pool().download(made);
            const auto host = on_host(points, used, stream.fillings());
            ASSERT_TRUE(host) << host.error().line();
            ASSERT_EQ(host->surfels.size(), expected.size());
            ASSERT_GT(expected.size(), 50u);
            for (size_t i = 0; i < expected.size(); ++i) {
                ASSERT_EQ(host->surfels[i].position, expected[i].position) << i;
                ASSERT_EQ(host->surfels[i].normal, expected[i].normal) << i;
                ASSERT_EQ(host->surfels[i].albedo, expected[i].albedo) << i;
                ASSERT_EQ(host->surfels[i].radius, expected[i].radius) << i;
                ASSERT_EQ(host->surfels[i].area, expected[i].area) << i;
                ASSERT_EQ(host->surfels[i].material, expected[i].material) << i;
            }
        }
    EXPECT_GT(filled, 0) << "some of these cuts have synthetic surfels";
}

TEST_F(HostCutTest, HashesTellShapesFromColours) {
    const auto first = on_host(20'000), again = on_host(20'000), other = on_host(10'000);
    ASSERT_TRUE(first && again && other);
    EXPECT_EQ(first->shapes, again->shapes);
    EXPECT_EQ(first->colours, again->colours);
    EXPECT_NE(first->shapes, other->shapes);
    scene_.look.colour = gi::ColourBy::elevation;
    const auto coloured = on_host(20'000);
    ASSERT_TRUE(coloured);
    EXPECT_EQ(first->shapes, coloured->shapes);
    EXPECT_NE(first->colours, coloured->colours);
}

}  // namespace
}  // namespace lucarne::viewer
