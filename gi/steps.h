// Computations that outlast a frame, such as light that is made while pictures show earlier light.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "io/core/error.h"

namespace lucarne::gi {

/// How much of such a computation is done at once.
struct StepBudget {
    enum class Kind : uint8_t {
        whole,   ///< all steps
        timed,   ///< at least one step; none begins after `seconds`
        paused,  ///< no step
    };
    Kind kind = Kind::whole;
    double seconds = 0;

    static StepBudget timed(double seconds) { return {Kind::timed, seconds}; }
    static StepBudget paused() { return {Kind::paused, 0}; }
    bool whole() const { return kind == Kind::whole; }
};

/// What a step says when it returns.
enum class StepResult : uint8_t {
    done,
    again,    ///< more of it remains: it is called again, perhaps in a later frame
    skipped,  ///< there was nothing to do: the next step follows at once
};

/// One step. `Context` is what all steps work on; it may differ from call to call.
template <class Context>
struct Step {
    std::string_view name;
    std::function<Result<StepResult>(Context&)> run;
};

/// Takes the steps of a computation in their order, as many as each budget allows.
template <class Context>
class StepRunner {
 public:
    /// Starts with the first of these steps. What earlier steps were doing is given up.
    void start(std::vector<Step<Context>> steps) {
        steps_ = std::move(steps);
        next_ = 0;
    }
    void cancel() { start({}); }
    bool running() const { return next_ < steps_.size(); }
    /// The name of the next step; empty if all are done.
    std::string_view step() const { return running() ? steps_[next_].name : std::string_view(); }

    /// Takes steps until all are done, the budget is spent, or `stop` is true (null: never). The error of a
    /// step cancels the rest.
    Result<void> run(Context& context, const StepBudget& budget, const std::atomic<bool>* stop = nullptr) {
        using Kind = StepBudget::Kind;
        if (budget.kind == Kind::paused) return {};
        const auto start = std::chrono::steady_clock::now();
        bool in_time = true;
        while (running() && in_time && !(stop && stop->load(std::memory_order_relaxed))) {
            const auto result = steps_[next_].run(context);
            if (!result) {
                cancel();
                return tl::make_unexpected(result.error());
            }
            next_ += *result != StepResult::again;
            const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
            in_time = budget.whole() || *result == StepResult::skipped || spent.count() < budget.seconds;
        }
        return {};
    }

 private:
    std::vector<Step<Context>> steps_;
    size_t next_ = 0;
};

}  // namespace lucarne::gi
