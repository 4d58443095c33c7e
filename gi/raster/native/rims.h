#pragma once

#include "gi/device/gl/device.h"
#include "gi/shared/camera.h"

namespace lucarne::gi::native {

/// Does what gi::turn_rims() does. `texels`: GBufferTexel[view.width * view.height]; `ids`: as many uint.
Result<void> turn_rims(const CameraView& view, const Buffer& texels, const Buffer& ids);

}  // namespace lucarne::gi::native
