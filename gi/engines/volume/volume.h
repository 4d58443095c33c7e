#pragma once

#include "gi/engine.h"

namespace lucarne::gi {

/// Light that is carried through voxels (Gaitatzes 2012, "Discretization methods for rendering in real time",
/// chapter 5, with transport by directions instead of diffusion).
EngineEntry volume_engine();

}  // namespace lucarne::gi
