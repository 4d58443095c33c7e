// What an engine is told of two frames that follow each other.
#include "gi/changes.h"

#include <gmock/gmock.h>

#include "gi/gl_frame.h"
#include "tests/gi/engines/analytic_frame.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(NodeChanges, AddedRemovedAndReplacedNodesAreToldApart) {
    const std::vector<CutNode> before = {{1, 10}, {2, 20}, {5, 50}, {9, 90}};
    const std::vector<CutNode> now = {{0, 1}, {2, 20}, {5, 51}, {12, 7}};
    const NodeChanges changes = node_changes(before, now);
    EXPECT_THAT(changes.added, ElementsAre(0, 12));
    EXPECT_THAT(changes.removed, ElementsAre(1, 9));
    EXPECT_THAT(changes.replaced, ElementsAre(5));
    EXPECT_TRUE(node_changes(before, before).empty());
    EXPECT_THAT(node_changes({}, before).added, ElementsAre(1, 2, 5, 9));
    EXPECT_THAT(node_changes(before, {}).removed, ElementsAre(1, 2, 5, 9));
}

class ChangeTrackerTest : public OnDevice {};

TEST_F(ChangeTrackerTest, EachInputHasARevisionOfItsOwnAndEqualFramesHaveEqualOnes) {
    PassTimes times(*device);
    const auto pool = SurfelPool::create(*device, 1);
    ASSERT_TRUE(pool);
    const DeviceCut cut;
    const GBuffer gbuffer;
    Buffer radiance;
    GlFrame gl{*device, *pool, {&cut, {}, &cut}, gbuffer, radiance};
    Frame frame{.gl = gl, .times = times};
    ChangeTracker tracker;
    const Changes first = tracker.next(frame);
    EXPECT_NE(first.scene, SceneRevisions()) << "what was kept of no frame is never right";
    frame.camera.width = 7;
    frame.index = 3;
    EXPECT_EQ(tracker.next(frame).scene, first.scene) << "the camera is no input of the light";

    frame.lights.resize(1);
    Changes now = tracker.next(frame);
    EXPECT_NE(now.scene.lights, first.scene.lights);
    EXPECT_EQ(now.scene.materials, first.scene.materials);
    frame.materials.resize(2);
    EXPECT_NE(tracker.next(frame).scene.materials, first.scene.materials);
    frame.bounds.max.x = 1;
    EXPECT_NE(tracker.next(frame).scene.bounds, first.scene.bounds);
    frame.environment = std::make_shared<Environment>();
    EXPECT_NE(tracker.next(frame).scene.environment, first.scene.environment);
    EXPECT_EQ(tracker.next(frame).look, first.look);
    frame.background.x = 1;
    now = tracker.next(frame);
    EXPECT_NE(now.look, first.look);
    EXPECT_EQ(now.scene.settings, first.scene.settings);

    frame.lights.clear();
    EXPECT_NE(tracker.next(frame).scene.lights, first.scene.lights) << "a revision never comes back";
}

TEST_F(ChangeTrackerTest, NodesOfACutThatComeGoOrAreReplacedAreNamedOnce) {
    const scenes::OneNode source(scenes::closed_box(2, 10, glm::vec3(.5f)));
    auto pool = SurfelPool::create(*device, 4096);
    ASSERT_TRUE(pool);
    const auto data = source.load(0);
    ASSERT_TRUE(data);
    const auto load = [&](const Scene& scene) {
        const auto fits = pool->load(0, pack_surfels(source.header(), source.nodes()[0], *data, scene));
        ASSERT_TRUE(fits && *fits);
    };
    load(Scene());
    DeviceCut cut;
    const auto choose = [&](std::vector<CutEntry> entries) {
        ASSERT_TRUE(pool->make_cut(*device, source, entries, glm::dvec3(0.0), cut));
    };
    PassTimes times(*device);
    const GBuffer gbuffer;
    Buffer radiance;
    GlFrame gl{*device, *pool, {&cut, {}, &cut}, gbuffer, radiance};
    Frame frame{.gl = gl, .times = times};
    ChangeTracker tracker;

    choose({});
    EXPECT_TRUE(tracker.next(frame).light_nodes.empty());
    choose({{0, 100}});
    const Changes came = tracker.next(frame);
    EXPECT_THAT(came.light_nodes.added, ElementsAre(0));
    EXPECT_THAT(came.view_nodes.added, ElementsAre(0));
    choose({{0, 100}});
    const Changes same = tracker.next(frame);
    EXPECT_TRUE(same.light_nodes.empty());
    EXPECT_EQ(same.light_cuts, came.light_cuts);
    choose({{0, 200}});
    const Changes more = tracker.next(frame);
    EXPECT_THAT(more.light_nodes.replaced, ElementsAre(0));
    EXPECT_NE(more.light_cuts, came.light_cuts);
    Scene darker;
    darker.albedo.flatten = 0;
    darker.materials.resize(2);
    darker.materials[1].classification = 0;
    load(darker);
    choose({{0, 200}});
    EXPECT_THAT(tracker.next(frame).light_nodes.replaced, ElementsAre(0))
        << "its surfels have another material";
    choose({});
    EXPECT_THAT(tracker.next(frame).light_nodes.removed, ElementsAre(0));
    EXPECT_TRUE(tracker.next(frame).view_nodes.empty());
}

}  // namespace
}  // namespace lucarne::gi
