#pragma once

#include "gi/engine.h"

namespace lucarne::gi {

/// Yue, Iwasaki, Dobashi & Nishita 2007, "Global illumination for interactive lighting design using light
/// path pre-computation and hierarchical histogram estimation".
EngineEntry paths_engine();

}  // namespace lucarne::gi
