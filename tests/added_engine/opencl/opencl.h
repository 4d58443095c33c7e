#pragma once

#include "gi/device/gl/context_watch.h"
#include "gi/engine.h"

namespace lucarne::gi {

/// An engine that paints all pixels on an OpenCL device.
EngineEntry opencl_engine();
/// After how many calls the engine's OpenCL devices are lost. Not thread-safe.
LossPlan& opencl_losses();

}  // namespace lucarne::gi
