#pragma once

#include "gi/engine.h"

namespace lucarne::gi {

/// Paints every surface in one colour: an engine with an option of every kind, to test what an engine's
/// folder needs.
EngineEntry paint_engine();

}  // namespace lucarne::gi
