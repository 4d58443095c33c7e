#pragma once

#include "gi/bounce_options.h"
#include "gi/engines/reference/options.h"
#include "gi/engines/vpl/options.h"

namespace lucarne::gi {

/// The settings of tests that choose no others: finer shadow maps and more paths than `interactive`, and one
/// bounce, which is quicker.
inline EngineSettings test_settings() {
    EngineSettings settings;
    settings.set(kBounces, 1);
    settings.set(vpl::kAtlas, 2048);
    settings.set(reference::kSamples, 64);
    return settings;
}

}  // namespace lucarne::gi
