// Draws the queued large discs, a workgroup each.
#include "gi/raster/large.glsl"

void main() { draw_large(large_ids[gl_WorkGroupID.x]); }
