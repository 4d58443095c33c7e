#pragma once

#include "gi/engine.h"

namespace lucarne::gi {

/// Direct light with shadow maps, from all kinds of lights: bounce 0 of every other engine.
EngineEntry direct_engine();

}  // namespace lucarne::gi
