#pragma once

#include <vector>

#include "gi/engine.h"
#include "gi/gl_frame.h"

namespace lucarne::gi {

/// Returns a frame's cuts, all of which are `cut`; of the light's cuts only those that the engine says it
/// needs, as in the viewer.
inline FrameCuts needed_cuts(const EngineInfo& engine, const DeviceCut& cut, size_t lights) {
    FrameCuts cuts{&cut, {}, engine.needs.light_cut ? &cut : nullptr};
    if (engine.needs.light_views) cuts.light_views.assign(lights, &cut);
    return cuts;
}

}  // namespace lucarne::gi
