// Parallel loops on std::thread for ThreadSanitizer, which does not see how TBB orders its tasks: Debian's
// libtbb is not built for it. Every other build uses TBB.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include <tbb/global_control.h>

namespace lucarne::plain_threads {

/// Runs each(i) for every i below `count` on several threads, as many as TBB may use and at most 4. The order
/// is not defined, and no call synchronizes with another. Rethrows what a call throws, after all have ended.
template <class Each>
void for_each(size_t count, const Each& each) {
    std::atomic<size_t> next{0};
    std::mutex mutex;
    std::exception_ptr thrown;
    const auto work = [&] {
        // Relaxed: an order between calls would hide their races.
        for (size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;) {
            try {
                each(i);
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!thrown) thrown = std::current_exception();
            }
        }
    };
    const size_t allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    std::vector<std::jthread> threads;
    for (size_t more = 1; more < std::min({allowed, count, size_t{4}}); ++more) threads.emplace_back(work);
    work();
    threads.clear();  // joins
    if (thrown) std::rethrow_exception(thrown);
}

}  // namespace lucarne::plain_threads
