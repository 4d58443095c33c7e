// A grid of all directions, in cells of equal solid angle, for C++ and GLSL.
#ifndef LUCARNE_GI_LIGHTING_SKY_GRID_H
#define LUCARNE_GI_LIGHTING_SKY_GRID_H

#include "gi/shared/environment.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

const uint kSkyColumns = 64u;
const uint kSkyRows = 32u;  // of equal height: their cells have equal solid angles (Archimedes)
const uint kSkyCells = kSkyColumns * kSkyRows;

// Returns the cell of a unit direction. Row 0 is at the zenith (+z).
LUCARNE_FN uint sky_cell(vec3 direction) {
    uint row = min(uint(0.5f * (1.0f - direction.z) * float(kSkyRows)), kSkyRows - 1u);
    uint column = uint(environment_place(direction, 0.0f).x * float(kSkyColumns));
    return row * kSkyColumns + min(column, kSkyColumns - 1u);
}

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
