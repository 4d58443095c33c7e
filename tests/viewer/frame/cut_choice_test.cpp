#include "viewer/frame/cut_choice.h"

#include <set>

#include <gtest/gtest.h>

#include "tests/octree/plane_source.h"

namespace lucarne::viewer {
namespace {

constexpr uint32_t kPoints = 100;

/// A lamp and a camera over a scanned square.
class CutChoice : public testing::Test {
 protected:
    octree::test::PlaneSource source{7, kPoints, 64.0};
    gi::SceneCamera camera;
    std::vector<gi::SceneLight> lights{1};
    gi::EngineNeeds needs{.light_cut = true, .light_views = true};

    CutChoice() {
        camera.position = {20, 20, 3};
        camera.target = {40, 40, 0};
        lights[0].position = {32, 32, 20};
        lights[0].target = {32, 32, 0};
    }

    CutPurpose purpose() const { return {source, camera, {640, 360}, needs, lights, 512, CutBudgets{}, 100}; }
    static CutRoom room(uint64_t nodes) {
        return {nodes, [](const octree::NodeInfo&) { return uint64_t{1}; }};
    }
    static size_t held(const CutSet& cuts) {
        std::set<uint32_t> nodes;
        for (const octree::Cut* cut : cuts.all())
            for (const octree::CutNode& node : cut->nodes) nodes.insert(node.node);
        return nodes.size();
    }
};

TEST_F(CutChoice, WithRoomForAllNothingIsGivenUp) {
    CutChooser chooser;
    const CutSet cuts = chooser.choose(purpose(), room(1'000'000));
    EXPECT_EQ(cuts.share, 1);
    EXPECT_EQ(cuts.light.points, source.header().points) << "the light cut takes all that its budget allows";
}

TEST_F(CutChoice, WhatFitsTogetherKeepsToNoParts) {
    CutChooser chooser;
    const size_t all = held(chooser.choose(purpose(), room(1'000'000)));
    EXPECT_EQ(chooser.choose(purpose(), room(all)).share, 1);
    EXPECT_LT(chooser.choose(purpose(), room(all - 1)).share, 1);
}

TEST_F(CutChoice, CutsShrinkUntilTheyFitAndTheLightsLeaveRoomForTheView) {
    CutChooser chooser;
    const CutSet whole = chooser.choose(purpose(), room(1'000'000));
    for (const uint64_t nodes : {500u, 100u, 20u}) {
        CutSet cuts = chooser.choose(purpose(), room(nodes));
        EXPECT_LE(held(cuts), nodes);
        EXPECT_LT(cuts.share, 1);
        EXPECT_GT(cuts.view.points, 0u);
        cuts.view = {};
        EXPECT_LE(held(cuts), nodes * 7 / 10);
        EXPECT_GT(held(cuts), nodes / 2) << nodes;
        cuts.light = {};
        EXPECT_LE(held(cuts), nodes / 2);
    }
}

TEST_F(CutChoice, WhereTheViewWantsMoreOrLessTheLightsCutsStay) {
    CutChooser chooser;
    const CutSet before = chooser.choose(purpose(), room(200));
    camera.target = {20.1, 20, 300};  // away from all
    const CutSet after = chooser.choose(purpose(), room(200));
    EXPECT_LT(after.view.points, before.view.points / 2);
    EXPECT_EQ(after.light.points, before.light.points);
    EXPECT_EQ(after.light.nodes.size(), before.light.nodes.size());
    EXPECT_EQ(after.light_views[0].points, before.light_views[0].points);
}

TEST_F(CutChoice, TheSameForAFrameWhateverWasChosenBefore) {
    CutChooser travelled;
    for (const uint64_t nodes : {20u, 2000u, 100u}) {
        camera.position.x += 7;
        travelled.choose(purpose(), room(nodes));
        for (const uint64_t other : {30u, 1500u}) {
            CutChooser fresh;
            EXPECT_EQ(travelled.choose(purpose(), room(other)).share,
                      fresh.choose(purpose(), room(other)).share);
        }
    }
}

TEST_F(CutChoice, WhereNothingFitsTheRootIsStillAsked) {
    CutChooser chooser;
    const CutSet cuts = chooser.choose(purpose(), room(0));
    EXPECT_GE(held(cuts), 1u);
    EXPECT_LT(held(cuts), 20u);
}

TEST_F(CutChoice, WhatNoEngineNeedsIsNotChosenAndLeavesItsRoomToTheView) {
    CutChooser chooser;
    const CutSet all = chooser.choose(purpose(), room(100));
    needs = {};
    const CutSet view = chooser.choose(purpose(), room(100));
    EXPECT_EQ(view.light.points, 0u);
    EXPECT_TRUE(view.light.nodes.empty());
    EXPECT_TRUE(view.light_views.empty());
    EXPECT_GT(view.view.points, all.view.points);
    needs = {.light_cut = true};
    const CutSet light = chooser.choose(purpose(), room(100));
    EXPECT_GT(light.light.points, 0u);
    EXPECT_TRUE(light.light_views.empty());
}

}  // namespace
}  // namespace lucarne::viewer
