// The light of the added engine is made in steps: a motion does not wait for it.
#include <gtest/gtest.h>

#include "gi/registry.h"
#include "gi/shared/luminance.h"
#include "tests/added_engine/paint/bands.h"
#include "tests/added_engine/paint/options.h"
#include "tests/gi/engines/lit_scene.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/on_device.h"

namespace lucarne::gi {
namespace {

using paint::kTint;

class AddedEngineSteps : public OnDevice {
 protected:
    void SetUp() override {
        OnDevice::SetUp();
        engine_ = *make_engine("paint");
    }
    glm::vec3 colour(const glm::dvec3& tint, const StepBudget& budget = {}) {
        options_.settings.set(kTint, tint);
        options_.moving = !budget.whole();
        options_.light_budget = budget;
        return light_up(*device, *engine_, cloud_, look({2, 1, 2}, {2, 4, 2}, 48, 48), options_).at(24, 24);
    }
    const SurfelCloud cloud_{scenes::closed_box(4, 60, glm::vec3(.5f))};
    LitOptions options_;
    std::unique_ptr<Engine> engine_;
};

TEST_F(AddedEngineSteps, AStillFrameTakesAllOfThem) {
    EXPECT_EQ(colour({.25, .5, 1}), glm::vec3(.25f, .5f, 1));
    EXPECT_EQ(engine_->stats().front().second, 1);
}

TEST_F(AddedEngineSteps, AMotionTakesOneAFrameAndShowsWhatWasFinishedLast) {
    const glm::dvec3 red(1, 0, 0), blue(0, 0, 1);
    EXPECT_EQ(colour(red, StepBudget::timed(0)), glm::vec3(0)) << "nothing is finished";
    EXPECT_EQ(colour(red), glm::vec3(red));
    for (uint32_t step = 0; step < paint::kBands; ++step)
        EXPECT_EQ(colour(blue, StepBudget::timed(0)), glm::vec3(red)) << step;
    EXPECT_EQ(colour(blue, StepBudget::paused()), glm::vec3(red)) << "a pause finishes nothing";
    EXPECT_EQ(colour(blue, StepBudget::timed(0)), glm::vec3(blue));
    EXPECT_EQ(colour(blue, StepBudget::paused()), glm::vec3(blue));
}

TEST_F(AddedEngineSteps, AChangedInputStartsThemAgain) {
    const glm::dvec3 red(1, 0, 0), blue(0, 0, 1), green(0, 1, 0);
    EXPECT_EQ(colour(red), glm::vec3(red));
    for (uint32_t step = 0; step < paint::kBands; ++step) colour(blue, StepBudget::timed(0));
    for (uint32_t step = 0; step < paint::kBands; ++step)
        EXPECT_EQ(colour(green, StepBudget::timed(0)), glm::vec3(red)) << step;
    EXPECT_EQ(colour(green, StepBudget::timed(0)), glm::vec3(green));
}

TEST_F(AddedEngineSteps, AFrameThatIsGivenUpIsContinued) {
    std::atomic<bool> stop = true;
    options_.stop = &stop;
    options_.settings.set(kTint, glm::dvec3(1, 0, 0));
    light_up(*device, *engine_, cloud_, look({2, 1, 2}, {2, 4, 2}, 48, 48), options_);
    EXPECT_EQ(engine_->stats().front().second, 0);
    stop = false;
    EXPECT_EQ(colour({1, 0, 0}), glm::vec3(1, 0, 0));
}

TEST_F(AddedEngineSteps, TheKernelUsesTheSharedFormula) {
    options_.settings.set(paint::kPattern, paint::Pattern::grey);
    const glm::vec3 grey = colour({.25, .5, 1});
    EXPECT_NEAR(grey.x, luminance(glm::vec3(.25f, .5f, 1)), 1e-6f);
    EXPECT_EQ(grey, glm::vec3(grey.x));
}

}  // namespace
}  // namespace lucarne::gi
