#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "io/core/error.h"
#include "io/core/job_queue.h"

namespace lucarne::viewer {

/// A thread that carries out one order at a time. `Shown` is what the window shows of it, with a member
/// `running`.
template <class Shown>
class SingleOrder {
 public:
    /// `changed` is called, by any thread, when shown() or take_outcome() has something new.
    explicit SingleOrder(std::function<void()> changed) : changed_(std::move(changed)) {}
    ~SingleOrder() { cancel(); }  ///< and waits
    SingleOrder(const SingleOrder&) = delete;
    SingleOrder& operator=(const SingleOrder&) = delete;

    /// Runs `work` on the thread; it returns a message. Returns false and does nothing while another order is
    /// running.
    template <class Work>
    bool start(std::string name, Shown first, Work work) {
        {
            const std::lock_guard lock(mutex_);
            if (shown_.running) return false;
            shown_ = std::move(first);
            shown_.running = true;
            outcome_.reset();
        }
        cancelled_ = false;
        jobs_.push(std::move(name), std::move(work),
                   [this](Result<std::string> done) { finish(std::move(done)); });
        return true;
    }
    void cancel() { cancelled_ = true; }
    const std::atomic<bool>& cancelled() const { return cancelled_; }

    /// Lets `change` edit what is shown. Tells the window if it returns true.
    template <class Change>
    void update(const Change& change) {
        {
            const std::lock_guard lock(mutex_);
            if (!change(shown_)) return;
        }
        changed_();
    }
    Shown shown() const {
        const std::lock_guard lock(mutex_);
        return shown_;
    }
    /// Returns the last order's message or error once.
    std::optional<Result<std::string>> take_outcome() {
        const std::lock_guard lock(mutex_);
        return std::exchange(outcome_, std::nullopt);
    }

 private:
    void finish(Result<std::string> done) {
        update([&](Shown& shown) {
            shown.running = false;
            outcome_ = std::move(done);
            return true;
        });
    }

    std::function<void()> changed_;
    std::atomic<bool> cancelled_{false};
    mutable std::mutex mutex_;
    Shown shown_{};
    std::optional<Result<std::string>> outcome_;
    JobQueue jobs_;  ///< the last member: it ends before what its jobs use
};

}  // namespace lucarne::viewer
