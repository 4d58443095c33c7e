// Where more discs are large than the queue holds: a workgroup a block of the cut draws all of the block's, one after
// the other.
#include "gi/raster/large.glsl"

void main() {
    for (uint place = 0u; place < kBlockSurfels; ++place) draw_large(gl_WorkGroupID.x * kBlockSurfels + place);
}
