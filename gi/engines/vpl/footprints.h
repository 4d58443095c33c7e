#pragma once

#include "gi/engines/vpl/shadow_maps/shadow_maps.h"

namespace lucarne::gi::vpl {

/// Makes the footprints of `seeds` no larger than what their own maps, drawn before, show to be clear of
/// their planes, and then `shrink` times that (0, 1]: 1 for a picture by itself, less for one of many that
/// are averaged. Errors: a shader that fails.
Result<void> trim_footprints(Device& device, const ShadowMaps& maps, float shrink, Seeds& seeds);

}  // namespace lucarne::gi::vpl
