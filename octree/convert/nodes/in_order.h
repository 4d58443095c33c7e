#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include <tbb/parallel_pipeline.h>

#include "io/core/parallel.h"

namespace lucarne::octree {

/// Makes `count` pieces in parallel, at most `most` at a time, and passes them on in order. make(i) returns a
/// Result; take(i, its value) returns Result<void>. Stops at the first failure.
template <class Make, class Take>
Result<void> in_order(size_t count, unsigned most, const Make& make, const Take& take) {
    using Piece = typename decltype(make(size_t{}))::value_type;
    struct Made {
        size_t index = 0;
        Piece piece;
    };
    FirstError error;
    const auto operation = log::Operation::current();
    const auto build = [&](size_t index) {
        const log::Operation::Scope scope(operation);
        auto result = std::make_shared<Made>(Made{index, {}});
        if (error.any()) return result;
        if (auto piece = make(index))
            result->piece = std::move(*piece);
        else
            error.report(index, std::move(piece).error());
        return result;
    };
    const auto hand_on = [&](const std::shared_ptr<Made>& result) {
        const log::Operation::Scope scope(operation);
        if (error.any()) return;
        if (auto done = take(result->index, std::move(result->piece)); !done)
            error.report(result->index, std::move(done).error());
    };
#ifdef __SANITIZE_THREAD__
    // As many pieces as may wait are made side by side, and then handed on.
    for (size_t first = 0; first < count && !error.any(); first += most) {
        std::vector<std::shared_ptr<Made>> made(std::min<size_t>(most, count - first));
        plain_threads::for_each(made.size(), [&](size_t i) { made[i] = build(first + i); });
        for (const auto& piece : made) hand_on(piece);
    }
#else
    size_t next = 0;
    const auto source = [&](tbb::flow_control& control) -> size_t {
        if (next == count || error.any()) control.stop();
        return next++;
    };
    tbb::parallel_pipeline(
        most, tbb::make_filter<void, size_t>(tbb::filter_mode::serial_in_order, source) &
                  tbb::make_filter<size_t, std::shared_ptr<Made>>(tbb::filter_mode::parallel, build) &
                  tbb::make_filter<std::shared_ptr<Made>, void>(tbb::filter_mode::serial_in_order, hand_on));
#endif
    return error.result();
}

}  // namespace lucarne::octree
