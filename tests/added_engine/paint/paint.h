#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include "gi/device/gl/context_watch.h"
#include "gi/engine.h"

namespace lucarne::gi {

/// An engine that paints surfaces in one colour and uses all that an engine may have: see README.md.
EngineEntry paint_engine();

/// What tests see of the engine, and how they hold it.
struct PaintHooks {
    std::atomic<uint32_t> steps = 0;  ///< that its precomputations have taken
    std::function<void(uint32_t)> before =
        nullptr;  ///< called on the job's thread before a step, with its number
    LossPlan opencl_losses{
        ""};  ///< after how many calls the engine's OpenCL devices are lost; not thread-safe
};
PaintHooks& paint_hooks();

}  // namespace lucarne::gi
