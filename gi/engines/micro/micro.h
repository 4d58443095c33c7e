#pragma once

#include "gi/engine.h"

namespace lucarne::gi {

/// Final gathering: every pixel looks at the light of all surfels through a micro-buffer (Ritschel et al.
/// 2009, "Micro-rendering for scalable, parallel final gathering").
EngineEntry micro_engine();

}  // namespace lucarne::gi
