#include "viewer/frame/quality.h"

#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/engines/vpl/options.h"
#include "gi/lighting/light_options.h"

namespace lucarne::viewer {
namespace {

TEST(MovingQuality, FastPicturesStayWhole) {
    MovingQuality quality;
    for (int i = 0; i < 100; ++i) quality.observe(0.02);
    EXPECT_EQ(quality.scale(), 1);
    EXPECT_FALSE(quality.reduced_settings());
}

TEST(MovingQuality, SlowPicturesGetSmallerFirstAndCheaperOnlyThen) {
    MovingQuality quality;
    quality.observe(0.2);
    EXPECT_LT(quality.scale(), 1);
    EXPECT_FALSE(quality.reduced_settings());
    for (int i = 0; i < 10; ++i) quality.observe(0.6);  // whatever the picture's size
    EXPECT_EQ(quality.scale(), 0.25);
    EXPECT_TRUE(quality.reduced_settings());
    EXPECT_EQ(quality.size({1280, 720}).width, 320u);
    EXPECT_EQ(quality.size({20, 20}).width, 16u) << "never nothing";
}

TEST(MovingQuality, ComesBackWhenPicturesAreFastAgain) {
    MovingQuality quality;
    for (int i = 0; i < 10; ++i) quality.observe(1.0);
    for (int i = 0; i < 60; ++i) quality.observe(0.01);
    EXPECT_EQ(quality.scale(), 1);
    EXPECT_FALSE(quality.reduced_settings());
}

TEST(MovingQuality, NeverMovesDearerThanAtRest) {
    MovingQuality quality;
    for (int i = 0; i < 10; ++i) quality.observe(1.0);
    ASSERT_TRUE(quality.reduced_settings());
    for (const Preset& preset : presets()) {
        gi::EngineSettings settings = preset.engine;
        settings.set(gi::kVpls, std::min(settings[gi::kVpls], 16u));
        CutBudgets budgets = preset.budgets;
        budgets.cap(1000);
        quality.reduce(settings, budgets);
        EXPECT_EQ(settings[gi::kVpls], 16u);
        EXPECT_EQ(budgets.view, 1000u);
        EXPECT_EQ(settings[gi::kBounces], preset.engine[gi::kBounces]) << "what is seen is the user's choice";
    }
}

TEST(MovingQuality, MovesWithTheLightOfThePresetInteractiveAtMost) {
    const Preset interactive = *find_preset("interactive"), high = *find_preset("high");
    MovingQuality quality;
    for (const bool slow : {false, true}) {
        if (slow)
            for (int i = 0; i < 10; ++i) quality.observe(1.0);
        gi::EngineSettings settings = high.engine;
        CutBudgets budgets = high.budgets;
        quality.reduce(settings, budgets);
        EXPECT_EQ(settings[gi::kVpls], interactive.engine[gi::kVpls]);
        EXPECT_EQ(settings[gi::vpl::kInterleave], interactive.engine[gi::vpl::kInterleave]);
        EXPECT_EQ(budgets.light < interactive.budgets.light, slow);
    }
}

TEST(MovingQuality, OneDisturbedPictureChangesNothing) {
    MovingQuality quality;
    for (int i = 0; i < 40; ++i) quality.observe(i % 3 == 1 ? 0.4 : 0.07);
    EXPECT_EQ(quality.scale(), 1);
}

TEST(MovingQuality, SettlesBelowTheLongestTime) {
    MovingQuality quality(0.1);
    const auto seconds = [&] { return 0.02 + 0.3 * quality.scale() * quality.scale(); };
    for (int i = 0; i < 60; ++i) quality.observe(seconds());
    EXPECT_LE(seconds(), 0.1);
    EXPECT_GE(seconds(), 0.05);
}

TEST(MovingQuality, StartsSmallWhereItIsTold) {
    EXPECT_EQ(MovingQuality(0.1, 0.5).size({640, 480}).width, 320u);
}

}  // namespace
}  // namespace lucarne::viewer
