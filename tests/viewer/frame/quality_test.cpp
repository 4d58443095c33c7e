#include "viewer/frame/quality.h"

#include <gtest/gtest.h>

#include "gi/bounce_options.h"
#include "gi/engines/vpl/options.h"

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
    for (int i = 0; i < 20; ++i) quality.observe(0.01);
    EXPECT_EQ(quality.scale(), 1);
    EXPECT_FALSE(quality.reduced_settings());
}

TEST(MovingQuality, NeverMovesDearerThanAtRest) {
    MovingQuality quality;
    for (int i = 0; i < 10; ++i) quality.observe(1.0);
    ASSERT_TRUE(quality.reduced_settings());
    for (const Preset& preset : presets()) {
        gi::EngineSettings settings = preset.engine;
        settings.set(gi::vpl::kVpls, std::min(settings[gi::vpl::kVpls], 16u));
        CutBudgets budgets = preset.budgets;
        budgets.cap(1000);
        quality.reduce(settings, budgets);
        EXPECT_EQ(settings[gi::vpl::kVpls], 16u);
        EXPECT_EQ(budgets.view, 1000u);
        EXPECT_EQ(settings[gi::kBounces], preset.engine[gi::kBounces]) << "what is seen is the user's choice";
    }
}

}  // namespace
}  // namespace lucarne::viewer
