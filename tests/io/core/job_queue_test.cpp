// Background jobs that throw: the requester is told, and the thread continues.
#include "io/core/job_queue.h"

#include <atomic>
#include <chrono>
#include <future>
#include <new>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>

namespace lucarne {
namespace {

using testing::HasSubstr;

/// Returns what the requester of `work` is told.
template <class Work>
Result<int> told(JobQueue& jobs, Work work) {
    std::promise<Result<int>> promise;
    jobs.push("sky.hdr", work, [&](Result<int> done) { promise.set_value(std::move(done)); });
    return promise.get_future().get();
}

TEST(JobQueue, WhatAJobThrowsIsTheErrorOfItsRequesterAndTheNextJobRuns) {
    JobQueue jobs;
    EXPECT_EQ(told(jobs, []() -> Result<int> { return 5; }).value(), 5);
    const auto memory = told(jobs, []() -> Result<int> { throw std::bad_alloc(); });
    ASSERT_FALSE(memory);
    EXPECT_THAT(memory.error().line(), HasSubstr("sky.hdr: there is not enough memory"));
    const auto reason = told(jobs, []() -> Result<int> { throw std::runtime_error("is bent"); });
    ASSERT_FALSE(reason);
    EXPECT_EQ(reason.error().line(), "sky.hdr: is bent");
    EXPECT_FALSE(told(jobs, []() -> Result<int> { throw 7; }));
    EXPECT_EQ(told(jobs, []() -> Result<int> { return 6; }).value(), 6);
}

TEST(JobQueue, AFailureThatNobodyWaitsForIsSaidOnTheTerminal) {
    testing::internal::CaptureStderr();
    {
        JobQueue jobs;
        jobs.push("the settings", []() -> Result<void> { throw std::bad_alloc(); });
        jobs.push(
            "listing", []() -> Result<int> { return 1; }, [](const Result<int>&) { throw std::bad_alloc(); });
        EXPECT_EQ(told(jobs, []() -> Result<int> { return 6; }).value(), 6) << "the thread goes on";
    }
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_THAT(said, HasSubstr("the settings: there is not enough memory"));
    EXPECT_THAT(said, HasSubstr("a background job: there is not enough memory"));
}

TEST(JobQueue, FinishWaitsForAllJobs) {
    std::atomic<int> done{0};
    JobQueue jobs;
    jobs.finish();
    for (int i = 0; i < 20; ++i)
        jobs.push("a job", [&]() -> Result<void> {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            ++done;
            return {};
        });
    jobs.finish();
    EXPECT_EQ(done, 20);
}

}  // namespace
}  // namespace lucarne
