#pragma once

#include "gi/raster/disc_view.h"
#include "gi/raster/native/tiles.h"
#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"

namespace lucarne::gi::native {

/// The rows first to last - 1 of a picture, whose coverage is written.
struct CoverageRows {
    const CameraView& camera;
    const DiscView& view;  ///< of the camera
    const GBufferTexel* texels;
    const uint32_t* ids;
    uint32_t* coverage;
    int first, last;
};

/// Finds how much of the pixels of some rows shows the surfaces of their neighbours, as coverage.comp.
void find_coverage(const CutMemory& cut, const CoverageRows& rows);

}  // namespace lucarne::gi::native
