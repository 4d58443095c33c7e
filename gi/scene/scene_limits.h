#pragma once

#include "io/files/json.h"

namespace lucarne::gi {

// Ranges of numbers that several objects of scene files share; data/README.md states them.
inline constexpr JsonRange kCoordinate{-1e9, 1e9}, kShare{0, 1}, kRadiance{0, 1e12};

inline constexpr size_t kMostLights = 64;  ///< of a scene

}  // namespace lucarne::gi
