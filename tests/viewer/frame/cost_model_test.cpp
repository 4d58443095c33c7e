#include "viewer/frame/cost_model.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace lucarne::viewer {
namespace {

/// A simulated machine with fixed costs of passes, disturbed in every seventh frame.
struct Machine {
    double view_ns = 50, light_ns = 20, fixed = 0.02;
    uint64_t wanted = 1'800'000;  ///< by the view, whatever the budget
    double loaded = 1;            ///< share of that
    std::mt19937 random{1};
    int frames = 0;

    FrameStats draw(const CutBudgets& budgets) {
        std::uniform_real_distribution<double> noise(0.97, 1.03);
        FrameStats frame;
        frame.view_points =
            static_cast<uint64_t>(loaded * static_cast<double>(std::min(budgets.view, wanted)));
        frame.wanted_points = std::min(budgets.view, wanted);
        frame.ready_points = frame.view_points;
        frame.light_view_points = budgets.light_view;
        frame.light_points = budgets.light;
        const double disturbed = ++frames % 7 == 0 ? 5 : 1;
        frame.passes = {
            {"G-buffer", 1e-9 * view_ns * static_cast<double>(frame.view_points) * noise(random) * disturbed},
            {"shade", fixed * noise(random) * disturbed},
            {"lights", 1e-9 * light_ns * static_cast<double>(frame.light_view_points) * noise(random)}};
        for (const auto& pass : frame.passes) frame.seconds += pass.seconds;
        return frame;
    }
    double quiet(const CutBudgets& budgets) const {
        return fixed + 1e-9 * view_ns * static_cast<double>(std::min(budgets.view, wanted)) +
               1e-9 * light_ns * static_cast<double>(budgets.light_view);
    }
};

constexpr ImageSize kSize{640, 360};

TEST(CostModel, LearnsEachPassFromTheCutThatItDrawsThoughFramesAreDisturbed) {
    CostModel model;
    Machine machine;
    std::mt19937 random(3);
    for (int i = 0; i < 24; ++i)
        model.observe(machine.draw({.view = 200'000 + random() % 1'000'000,
                                    .light_view = 100'000 + random() % 900'000,
                                    .light = 300'000}));
    const auto line = model.line();
    ASSERT_TRUE(line);
    EXPECT_NEAR(line->per_point[0], 50e-9, 5e-9);
    EXPECT_NEAR(line->per_point[1], 20e-9, 3e-9);
    EXPECT_EQ(line->per_point[2], 0) << "nothing is said of a cut that never changed";
    EXPECT_NEAR(line->fixed, 0.02, 0.003);
}

TEST(CostModel, KnowsNothingBeforeTheFirstFrame) {
    CostModel model;
    EXPECT_FALSE(model.line());
    model.observe(Machine().draw({}));
    EXPECT_TRUE(model.line());
    model.forget();
    EXPECT_FALSE(model.line());
}

TEST(FrameBudget, FramesComeToTheirTimeAndStayThere) {
    FrameBudget budget(0.08);
    Machine machine;
    for (int frame = 0; frame < 60; ++frame) {
        budget.observe(machine.draw(budget.budgets({})), kSize);
        if (frame < 20) continue;
        EXPECT_NEAR(machine.quiet(budget.budgets({})), 0.08, 0.008) << frame;
    }
    EXPECT_EQ(budget.budgets({}).light, CutBudgets{}.light) << "the view alone was enough";
}

TEST(FrameBudget, WhatIsFastEnoughIsLeftWhole) {
    FrameBudget budget(0.5);
    Machine machine;
    for (int frame = 0; frame < 30; ++frame) budget.observe(machine.draw(budget.budgets({})), kSize);
    EXPECT_GE(budget.budgets({}).view, machine.wanted);
    EXPECT_EQ(budget.budgets({}).light_view, CutBudgets{}.light_view);
}

TEST(FrameBudget, WhatIsStillLoadingHoldsNothingDown) {
    FrameBudget budget(0.08);
    Machine machine;
    for (const double loaded : {0.0, 0.0, 1e-6, 0.01, 0.2}) {
        machine.loaded = loaded;
        budget.observe(machine.draw(budget.budgets({})), kSize);
        EXPECT_EQ(budget.budgets({}).view, CutBudgets{}.view) << loaded;
    }
    machine.loaded = 1;
    for (int frame = 0; frame < 40; ++frame) budget.observe(machine.draw(budget.budgets({})), kSize);
    EXPECT_NEAR(machine.quiet(budget.budgets({})), 0.08, 0.008);
}

TEST(FrameBudget, FollowsAMachineThatBecomesSlowerAndFasterAgain) {
    FrameBudget budget(0.08);
    Machine machine;
    const auto settle = [&](double view_ns) {
        machine.view_ns = view_ns;
        for (int frame = 0; frame < 60; ++frame) budget.observe(machine.draw(budget.budgets({})), kSize);
        return machine.quiet(budget.budgets({}));
    };
    EXPECT_NEAR(settle(50), 0.08, 0.008);
    EXPECT_NEAR(settle(120), 0.08, 0.012);
    EXPECT_NEAR(settle(50), 0.08, 0.012);
}

TEST(FrameBudget, LightsCutsGiveWayOnlyWhereTheViewsLeastIsTooSlow) {
    FrameBudget budget(0.03);
    Machine machine;  // shading and lights alone take .04 s
    for (int frame = 0; frame < 80; ++frame) budget.observe(machine.draw(budget.budgets({})), kSize);
    const CutBudgets budgets = budget.budgets({});
    EXPECT_LT(budgets.light_view, CutBudgets{}.light_view);
    EXPECT_LT(machine.quiet(budgets), 0.034);
    EXPECT_GE(budgets.view, machine.wanted / 17) << "a picture is left";
}

}  // namespace
}  // namespace lucarne::viewer
