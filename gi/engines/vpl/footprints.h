#pragma once

#include "gi/engines/vpl/shadow_maps/shadow_maps.h"

namespace lucarne::gi::vpl {

/// Shrinks the footprints of `seeds` to the part that their own maps, drawn before, show to be clear of
/// other surfaces, then multiplies them by `shrink` (0, 1]: 1 for a single picture, less for one of many
/// that are averaged. Errors: a shader that fails.
Result<void> trim_footprints(Device& device, const ShadowMaps& maps, float shrink, Seeds& seeds);

}  // namespace lucarne::gi::vpl
