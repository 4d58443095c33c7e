#pragma once

#include <memory>

#include "gi/engine.h"

namespace lucarne::gi {

/// Virtual point lights with imperfect shadow maps (Preiner 2010): see README.md here.
std::unique_ptr<Engine> make_vpl_engine();

}  // namespace lucarne::gi
