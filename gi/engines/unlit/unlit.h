#pragma once

#include <memory>

#include "gi/engine.h"

namespace lucarne::gi {

/// The points' colours as they are, shaded by shape alone: see README.md beside this file.
std::unique_ptr<Engine> make_unlit_engine();

}  // namespace lucarne::gi
