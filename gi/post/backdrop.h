#pragma once

#include "gi/device/gl/device.h"
#include "gi/raster/gbuffer.h"
#include "gi/scene/look.h"

namespace lucarne::gi {

/// Fills the pixels of a tone-mapped picture that show no point with the backdrop. `averaged`: `radiance` is
/// an average of several frames (gi/post/accumulate.h), whose points are blended with the backdrop by their
/// share of the pixel. A backdrop of kind `scene` changes nothing. Errors: the shader's.
Result<void> draw_backdrop(Device& device, const GBuffer& gbuffer, const Buffer& radiance, bool averaged,
                           const Backdrop& backdrop, Buffer& picture);

}  // namespace lucarne::gi
