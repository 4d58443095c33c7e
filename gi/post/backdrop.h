#pragma once

#include "gi/device/gl/device.h"
#include "gi/raster/gbuffer.h"
#include "gi/scene/look.h"

namespace lucarne::gi {

/// Gives the pixels of a tone-mapped picture that show no point the backdrop's colour; one of kind `scene`
/// leaves them as they are. Errors: the shader's.
Result<void> draw_backdrop(Device& device, const GBuffer& gbuffer, const Backdrop& backdrop, Buffer& picture);

}  // namespace lucarne::gi
