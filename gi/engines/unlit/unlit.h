#pragma once

#include "gi/engine.h"

namespace lucarne::gi {

/// The points' colours without light, shaded by shape alone: see README.md beside this file.
EngineEntry unlit_engine();

}  // namespace lucarne::gi
