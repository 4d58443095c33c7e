#include "gi/steps.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lucarne::gi {
namespace {

using testing::ElementsAre;

/// Writes down which steps were taken.
struct Log {
    std::vector<std::string> taken;
};

Step<Log> noted(std::string_view name, StepResult result = StepResult::done) {
    return {name, [name, result](Log& log) -> Result<StepResult> {
                log.taken.emplace_back(name);
                return result;
            }};
}

TEST(Steps, AllAreTakenInTheirOrder) {
    StepRunner<Log> runner;
    Log log;
    EXPECT_FALSE(runner.running());
    runner.start({noted("a"), noted("b"), noted("c")});
    EXPECT_TRUE(runner.running());
    EXPECT_EQ(runner.step(), "a");
    ASSERT_TRUE(runner.run(log, {}));
    EXPECT_FALSE(runner.running());
    EXPECT_EQ(runner.step(), "");
    EXPECT_THAT(log.taken, ElementsAre("a", "b", "c"));
}

TEST(Steps, ABudgetWithoutTimeTakesOneAndAPausedOneNone) {
    StepRunner<Log> runner;
    Log log;
    runner.start({noted("a"), noted("b")});
    ASSERT_TRUE(runner.run(log, StepBudget::paused()));
    EXPECT_TRUE(log.taken.empty());
    ASSERT_TRUE(runner.run(log, StepBudget::timed(0)));
    EXPECT_THAT(log.taken, ElementsAre("a"));
    EXPECT_EQ(runner.step(), "b");
    ASSERT_TRUE(runner.run(log, StepBudget::timed(1e9)));
    EXPECT_THAT(log.taken, ElementsAre("a", "b"));
}

TEST(Steps, OneThatHadNothingToDoCostsNoTime) {
    StepRunner<Log> runner;
    Log log;
    runner.start({noted("a", StepResult::skipped), noted("b"), noted("c")});
    ASSERT_TRUE(runner.run(log, StepBudget::timed(0)));
    EXPECT_THAT(log.taken, ElementsAre("a", "b"));
}

TEST(Steps, OneMayTakeSeveralCalls) {
    StepRunner<Log> runner;
    Log log;
    int calls = 0;
    runner.start(
        {{"chunks",
          [&](Log&) -> Result<StepResult> { return ++calls < 3 ? StepResult::again : StepResult::done; }},
         noted("b")});
    ASSERT_TRUE(runner.run(log, StepBudget::timed(0)));
    EXPECT_EQ(runner.step(), "chunks");
    ASSERT_TRUE(runner.run(log, {}));
    EXPECT_EQ(calls, 3);
    EXPECT_THAT(log.taken, ElementsAre("b"));
}

TEST(Steps, AFailureCancelsTheRest) {
    StepRunner<Log> runner;
    Log log;
    runner.start({{"bad", [](Log&) -> Result<StepResult> { return failed("bad", "it fails"); }}, noted("b")});
    const auto done = runner.run(log, {});
    ASSERT_FALSE(done);
    EXPECT_THAT(done.error().line(), testing::HasSubstr("it fails"));
    EXPECT_FALSE(runner.running());
    ASSERT_TRUE(runner.run(log, {}));
    EXPECT_TRUE(log.taken.empty());
}

TEST(Steps, StopIsSeenBetweenStepsAndTheyGoOnLater) {
    StepRunner<Log> runner;
    Log log;
    std::atomic<bool> stop = false;
    runner.start({{"stops",
                   [&](Log&) -> Result<StepResult> {
                       stop = true;
                       return StepResult::done;
                   }},
                  noted("b")});
    ASSERT_TRUE(runner.run(log, {}, &stop));
    EXPECT_TRUE(runner.running());
    EXPECT_TRUE(log.taken.empty());
    stop = false;
    ASSERT_TRUE(runner.run(log, {}, &stop));
    EXPECT_THAT(log.taken, ElementsAre("b"));
}

TEST(Steps, AStartBeginsAgain) {
    StepRunner<Log> runner;
    Log log;
    runner.start({noted("old"), noted("older")});
    ASSERT_TRUE(runner.run(log, StepBudget::timed(0)));
    runner.start({noted("new")});
    ASSERT_TRUE(runner.run(log, {}));
    EXPECT_THAT(log.taken, ElementsAre("old", "new"));
    runner.start({noted("never")});
    runner.cancel();
    ASSERT_TRUE(runner.run(log, {}));
    EXPECT_THAT(log.taken, ElementsAre("old", "new"));
}

}  // namespace
}  // namespace lucarne::gi
