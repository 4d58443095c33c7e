#pragma once

#include "gi/engine.h"

namespace lucarne::gi {

/// Harada 2014, "Micro-buffer rasterization reduction method for environment lighting using point-based
/// rendering".
EngineEntry environment_engine();

}  // namespace lucarne::gi
