#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include "gi/engine.h"

namespace lucarne::gi {

inline constexpr uint32_t kMeanSteps = 8;  ///< of its precomputation

/// An engine that paints every surface in the mean colour of the scan, which it computes in advance, in
/// steps. Before it is known, surfaces are black.
EngineEntry mean_engine();

/// What tests see of its precomputations, and how they hold them.
struct MeanHooks {
    std::atomic<uint32_t> steps = 0;  ///< taken so far
    std::function<void(uint32_t)> before =
        nullptr;  ///< called on the job's thread before a step, with its number
};
MeanHooks& mean_hooks();

}  // namespace lucarne::gi
