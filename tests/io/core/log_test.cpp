// Warnings: printed once in an operation, and again in the next.
#include "io/core/log.h"

#include <thread>

#include <gmock/gmock.h>

#include "io/core/guarded.h"
#include "io/core/parallel.h"

namespace lucarne {
namespace {

using ::testing::HasSubstr;

/// Counts how often `act` prints `line`.
template <class Act>
int times_said(const std::string& line, const Act& act) {
    ::testing::internal::CaptureStderr();
    act();
    const std::string said = ::testing::internal::GetCapturedStderr();
    int times = 0;
    for (size_t at = said.find(line); at != said.npos; at = said.find(line, at + 1)) ++times;
    return times;
}

TEST(Log, AWarningIsSaidOnceInAnOperationAndAgainInTheNext) {
    const int times = times_said("a.las is damaged", [] {
        for (int operation = 0; operation < 3; ++operation) {
            const log::Operation::Scope scope{log::Operation()};
            for (int i = 0; i < 5; ++i) log::warn("a.las is damaged");
        }
    });
    EXPECT_EQ(times, 3);
}

TEST(Log, OutsideOfOperationsEveryWarningIsSaid) {
    EXPECT_EQ(times_said("no space",
                         [] {
                             for (int i = 0; i < 3; ++i) log::warn("no space");
                         }),
              3);
}

TEST(Log, AnInnerOperationHasWarningsOfItsOwnAndEndsWithItsScope) {
    const int times = times_said("a.las is damaged", [] {
        const log::Operation::Scope outer{log::Operation()};
        log::warn("a.las is damaged");
        {
            const log::Operation::Scope inner{log::Operation()};
            log::warn("a.las is damaged");
        }
        log::warn("a.las is damaged");
    });
    EXPECT_EQ(times, 2);
}

TEST(Log, ThreadsThatEnterAnOperationShareItsWarnings) {
    const int times = times_said("a.las is damaged", [] {
        const log::Operation operation;
        const auto work = [&] {
            const log::Operation::Scope scope(operation);
            log::warn("a.las is damaged");
        };
        std::thread(work).join();
        std::thread(work).join();
        work();
    });
    EXPECT_EQ(times, 1);
}

TEST(Log, AParallelLoopBelongsToItsCallersOperation) {
    const int times = times_said("a.las is damaged", [] {
        const log::Operation::Scope scope{log::Operation()};
        parallel_ranges(1000, 1, [](size_t, size_t) { log::warn("a.las is damaged"); });
    });
    EXPECT_EQ(times, 1);
}

TEST(Guarded, WhateverIsThrownIsAnErrorAboutItsSubject) {
    const auto line = [](auto thrown) {
        return guarded("node 5", [&]() -> Result<int> { throw thrown; }).error().line();
    };
    EXPECT_THAT(line(std::bad_alloc()), HasSubstr("node 5: there is not enough memory; "));
    EXPECT_EQ(line(std::runtime_error("is gone")), "node 5: is gone");
    EXPECT_EQ(line(7), "node 5: failed for an unknown reason");
    EXPECT_EQ(guarded("", []() -> Result<int> { return 3; }).value(), 3);
    EXPECT_TRUE(guarded("", [] {}));
    EXPECT_FALSE(guarded("", [] { throw 1; }));
}

}  // namespace
}  // namespace lucarne
