#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "io/core/guarded.h"

namespace lucarne {

/// A thread that runs one job after another, so that the window's thread never waits.
class JobQueue {
 public:
    JobQueue() : thread_([this] { work(); }) {}
    /// Waits for the running job. Jobs that have not begun are dropped.
    ~JobQueue();
    /// Waits until all jobs are done.
    void finish();
    JobQueue(const JobQueue&) = delete;
    JobQueue& operator=(const JobQueue&) = delete;

    /// Runs `work` on the queue's thread and then, on the same thread, `done` with the Result of `work`. An
    /// exception from `work` (out of memory) becomes an error about `what`, so `done` is always called.
    template <class Work, class Done>
    void push(std::string what, Work work, Done done) {
        push_job([what = std::move(what), work = std::move(work), done = std::move(done)]() mutable {
            done(guarded(what, work));
        });
    }
    /// The same for callers that do not need the result. An error becomes a warning on the terminal.
    template <class Work>
    void push(std::string what, Work work) {
        push(std::move(what), std::move(work), warn_of);
    }

 private:
    using Job = std::function<void()>;
    static void warn_of(const Result<void>& done);
    void push_job(Job job);
    void work();

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Job> jobs_;
    bool stop_ = false, running_ = false;
    std::thread thread_;
};

}  // namespace lucarne
