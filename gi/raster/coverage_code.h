// How much of a pixel at an edge shows the surfaces of its neighbours, shared by C++ and GLSL.
#ifndef LUCARNE_GI_RASTER_COVERAGE_CODE_H
#define LUCARNE_GI_RASTER_COVERAGE_CODE_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::raster {
#endif

// A pixel's word has four bits for each of its eight neighbours, row by row: the number of its samples that
// show the neighbour's surface. The other samples show its own.
LUCARNE_CONST uint kCoverageSamples = 8u;
LUCARNE_CONST uint kCoverageNeighbours = 8u;

// Returns the offset of a neighbour from its pixel; 7 - i is the opposite one.
LUCARNE_FN ivec2 coverage_neighbour(uint i) {
    int place = int(i) + (i < 4u ? 0 : 1);
    return ivec2(place % 3 - 1, place / 3 - 1);
}

// Returns the place of a sample in its pixel, -.5 to .5: no two in one row or column of an 8 x 8 grid.
LUCARNE_FN vec2 coverage_sample(uint i) {
    // x, and then y, in 16ths of a pixel plus 8, four bits each.
    uint x = 0xfb135d79u >> (4u * i) & 15u;
    uint y = 0x1f7d39b5u >> (4u * i) & 15u;
    return vec2(float(x), float(y)) / 16.0f - 0.5f;
}

#ifdef __cplusplus
}  // namespace lucarne::gi::raster
#endif
#endif
