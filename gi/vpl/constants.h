// What stays the same for all passes of a frame (std430), shared by C++ and GLSL.
#ifndef LUCARNE_GI_VPL_CONSTANTS_H
#define LUCARNE_GI_VPL_CONSTANTS_H

#include "gi/shared/camera.h"
#include "gi/shared/material.h"

#ifdef __cplusplus
namespace lucarne::gi::vpl {
#endif

struct FrameConstants {
    CameraView camera;
    CameraView light_view;  // of the spot that the VPLs come from
    SpotLight spot;
    vec4 background;        // rgb radiance, W/(sr m^2)
};

#ifdef __cplusplus
static_assert(sizeof(FrameConstants) == 224);
}  // namespace lucarne::gi::vpl
#endif
#endif
