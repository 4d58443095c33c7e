#pragma once

#include <memory>

#include "gi/engine.h"

namespace lucarne::gi {

/// A path tracer over the surfels of the light cut, starting from the G-buffer: see gi/engines/reference/README.md.
std::unique_ptr<Engine> make_reference_engine();

}  // namespace lucarne::gi
