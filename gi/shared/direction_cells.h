// Cells of directions, for C++ and OpenCL C: of an octahedral map of kDirectionCellsASide a side, which
// sorts arriving light by direction.
#ifndef LUCARNE_GI_SHARED_DIRECTION_CELLS_H
#define LUCARNE_GI_SHARED_DIRECTION_CELLS_H

#include "gi/shared/surfel_code.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

LUCARNE_CONST uint kDirectionCellsASide = 12u;
LUCARNE_CONST uint kDirectionCells = 144u;

// Returns the cell of a unit direction.
LUCARNE_FN uint direction_cell(vec3 direction) {
    uint code = encode_octahedral(direction);
    uint x = (code & 0xffffu) * kDirectionCellsASide >> 16, y = (code >> 16) * kDirectionCellsASide >> 16;
    return y * kDirectionCellsASide + x;
}
// Returns the direction in the middle of a cell.
LUCARNE_FN vec3 direction_of_cell(uint cell) {
    uint x = cell % kDirectionCellsASide, y = cell / kDirectionCellsASide;
    return decode_octahedral((2u * x + 1u) * 0x8000u / kDirectionCellsASide |
                             (2u * y + 1u) * 0x8000u / kDirectionCellsASide << 16);
}

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
