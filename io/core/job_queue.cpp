#include "io/core/job_queue.h"

#include "io/core/log.h"

namespace lucarne {

JobQueue::~JobQueue() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void JobQueue::finish() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return jobs_.empty() && !running_; });
}

void JobQueue::push_job(Job job) {
    {
        const std::lock_guard lock(mutex_);
        jobs_.push_back(std::move(job));
    }
    changed_.notify_all();
}

void JobQueue::warn_of(const Result<void>& done) {
    if (!done) log::warn("{}", done.error().line());
}

void JobQueue::work() {
    for (;;) {
        Job job;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] { return stop_ || !jobs_.empty(); });
            if (stop_) return;
            job = std::move(jobs_.front());
            jobs_.pop_front();
            running_ = true;
        }
        warn_of(guarded("a background job", job));  // `work` is guarded already; only `done` can throw here
        {
            const std::lock_guard lock(mutex_);
            running_ = false;
        }
        changed_.notify_all();
    }
}

}  // namespace lucarne
