// Blends the large discs if there are more than the queue holds: a workgroup blends all of those in a block of the cut.
#include "gi/raster/blend_large.glsl"

void main() {
    for (uint place = 0u; place < kBlockSurfels; ++place) blend_large(gl_WorkGroupID.x * kBlockSurfels + place);
}
