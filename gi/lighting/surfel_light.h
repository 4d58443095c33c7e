#pragma once

#include "gi/gl_frame.h"
#include "gi/lighting/light_view.h"

namespace lucarne::gi {

/// Adds the irradiance, W/m^2, that the sides of `count` surfels (FlatSurfel[], flatten()) receive of one
/// light, as far as one of its views shows it. `irradiance`: r, g, b of the front of each surfel, then of
/// its back. `seen` is the G-buffer that rasterize() drew of that view. `directions`, if not null, is of the
/// same shape: the unit vectors to the light, times the mean of the three colours of its irradiance, are
/// added to it. Errors: a shader that fails.
Result<void> add_surfel_light(Device& device, const Buffer& surfels, uint32_t count, const LightView& from,
                              const GBuffer& seen, const Buffer& irradiance,
                              const Buffer* directions = nullptr);

}  // namespace lucarne::gi
