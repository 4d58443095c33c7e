// How the texels of a sky that points gather lie in their buffer, for C++ and OpenCL C.
#ifndef LUCARNE_GI_GATHER_SKY_PICTURE_H
#define LUCARNE_GI_GATHER_SKY_PICTURE_H

#include "gi/shared/environment.h"
#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

LUCARNE_STRUCT(SkyPicture) {
    uint width, height;  // texels of three floats, in rows from the zenith down; 0: the sky is dark
    float rotation;      // as environment_place() takes it, radians
    uint unused;         // structs that kernels take have 16 bytes
};

#ifdef __cplusplus
static_assert(sizeof(SkyPicture) == 16);
}  // namespace lucarne::gi
#endif
#endif
