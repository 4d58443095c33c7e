// One invocation a surfel: draws small discs pixel by pixel and queues large ones for splat_large.comp.
layout(local_size_x = 256) in;
#include "gi/gbuffer/splat.glsl"

const int kLargePixels = 256;

void main() {
    uint id = gl_GlobalInvocationID.x;
    uint item;
    PackedSurfel surfel;
    Disc disc;
    ivec4 box;
    ivec2 home;
    if (!cut_surfel(id, item, surfel) || !view_disc(item, surfel, disc) || !disc_box(disc, box, home)) return;
    ivec2 size = box.zw - box.xy + 1;
    if (size.x * size.y > kLargePixels) {
        uint place = atomicAdd(large_count, 1u);
        if (place < uint(large_ids.length())) {
            large_ids[place] = id;
            atomicMax(large_groups[0], place + 1u);
            return;
        }
    }
    for (int y = box.y; y <= box.w; ++y)
        for (int x = box.x; x <= box.z; ++x) take_pixel(disc, id, ivec2(x, y), home);
}
