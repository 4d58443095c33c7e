#pragma once

#include "gi/raster/gbuffer.h"

namespace lucarne::gi {

/// Lights the rims of surfaces on their front. Where a surface turns away from the viewer, discs beyond its
/// outline stick out and are seen from behind; lit on that side, inside a solid body, they would be black.
/// Such a texel has the front of the same surface beside it (is_one_surface): its normal is turned only as
/// far as to stand at right angles to its ray. Surfaces that are seen from behind as a whole stay as they
/// are. Call it after rasterize() or blend(). Errors: the shader's.
Result<void> turn_rims(Device& device, const CameraView& view, GBuffer& target);

}  // namespace lucarne::gi
