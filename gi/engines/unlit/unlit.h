#pragma once

#include "gi/engine.h"

namespace lucarne::gi {

/// The points' colours as they are, shaded by shape alone: see README.md beside this file.
EngineEntry unlit_engine();

}  // namespace lucarne::gi
