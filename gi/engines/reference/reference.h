#pragma once

#include "gi/engine.h"

namespace lucarne::gi {

/// A path tracer over the surfels of the light cut, starting from the G-buffer: see
/// gi/engines/reference/README.md.
EngineEntry reference_engine();

}  // namespace lucarne::gi
