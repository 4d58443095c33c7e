#pragma once

#include "gi/engine.h"

namespace lucarne::gi {

/// Virtual point lights with imperfect shadow maps (Preiner 2010): see README.md beside this file.
EngineEntry vpl_engine();

}  // namespace lucarne::gi
