// Draws the large discs if there are more than the queue holds: a workgroup draws all of those in a block of the cut,
// one after the other.
#include "gi/raster/large.glsl"

void main() {
    for (uint place = 0u; place < kBlockSurfels; ++place) draw_large(gl_WorkGroupID.x * kBlockSurfels + place);
}
