#pragma once

#include "gi/engine.h"

namespace lucarne::gi {

/// An engine that paints every surface in one colour. It has an option of every kind, to test what a new
/// engine needs.
EngineEntry paint_engine();

}  // namespace lucarne::gi
