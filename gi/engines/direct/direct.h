#pragma once

#include "gi/engine.h"

namespace lucarne::gi {

/// Light from the spots after one reflection, with shadow maps: bounce 0 of every other engine.
EngineEntry direct_engine();

}  // namespace lucarne::gi
