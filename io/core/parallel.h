#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include "io/core/error.h"
#include "io/core/log.h"

#ifdef __SANITIZE_THREAD__
#include "io/core/plain_threads.h"
#endif

namespace lucarne {

/// Limits the threads of every parallel loop while it lives; 0 means all cores.
class ThreadLimit {
 public:
    explicit ThreadLimit(unsigned threads)
        : control_(tbb::global_control::max_allowed_parallelism,
                   threads ? threads : std::max(1u, std::thread::hardware_concurrency())) {}

 private:
    tbb::global_control control_;
};

/// Calls body(first, last) for consecutive pieces of [0, count), each at most `grain` long, in parallel. The
/// pieces do not depend on the number of threads, so a body that depends on nothing but its piece gives the
/// same result in every run. Warnings of the body belong to the caller's operation. An exception of the body
/// is rethrown here.
template <class Body>
void parallel_ranges(size_t count, size_t grain, const Body& body) {
    const size_t pieces = (count + grain - 1) / grain;
    const auto operation = log::Operation::current();
    const auto run = [&](size_t piece) {
        const log::Operation::Scope scope(operation);
        const size_t first = piece * grain;
        body(first, std::min(count, first + grain));
    };
#ifdef __SANITIZE_THREAD__
    plain_threads::for_each(pieces, run);
#else
    tbb::parallel_for(size_t{0}, pieces, run);
#endif
}

/// Collects the errors of parallel work and keeps the one with the lowest `order`. If every piece is tried,
/// the message therefore does not depend on timing.
class FirstError {
 public:
    void report(size_t order, Error error) {
        const std::lock_guard lock(mutex_);
        if (!error_ || order < order_) {
            error_ = std::move(error);
            order_ = order;
        }
        any_ = true;
    }
    bool any() const { return any_; }
    Result<void> result() {
        const std::lock_guard lock(mutex_);
        if (error_) return tl::make_unexpected(*error_);
        return {};
    }

 private:
    std::mutex mutex_;
    std::optional<Error> error_;
    size_t order_ = 0;
    std::atomic<bool> any_{false};
};

}  // namespace lucarne
