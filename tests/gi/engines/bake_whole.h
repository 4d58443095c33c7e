#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "gi/bake/precomputation.h"
#include "gi/engine.h"

namespace lucarne::gi {

/// Returns all that an engine computes in advance for these surfels, of which all materials and lights are
/// unknown; null if it computes nothing. Errors: its own.
inline Result<std::shared_ptr<const Bake>> bake_whole(const EngineInfo& engine, std::vector<Surfel> surfels,
                                                      const Bounds& bounds, const EngineSettings& settings) {
    if (!engine.precomputes) return nullptr;
    BakeInput input;
    input.cut.surfels = std::move(surfels);
    input.cut.bounds = bounds;
    input.settings = settings;
    const auto work = engine.precomputes->make();
    StepRunner<const BakeInput> runner;
    runner.start(work->steps(input));
    LUCARNE_TRY(runner.run(input, StepBudget{}));
    return work->snapshot();
}

}  // namespace lucarne::gi
