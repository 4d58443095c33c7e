#pragma once

#include "gi/device/gl/device.h"
#include "gi/shared/camera.h"

namespace lucarne::gi::native {

/// Turns the normals of rims as gi::turn_rims() does. `texels`: GBufferTexel[view.width * view.height].
Result<void> turn_rims(const CameraView& view, const Buffer& texels);

}  // namespace lucarne::gi::native
