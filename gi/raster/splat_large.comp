// A workgroup for each disc of the queue.
#include "gi/raster/large.glsl"

void main() { draw_large(large_ids[gl_WorkGroupID.x]); }
