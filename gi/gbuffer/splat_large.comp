// One disc of the queue for each group in x; the groups in y share its rows, the invocations of a group its pixels.
layout(local_size_x = 64) in;
#include "gi/gbuffer/splat.glsl"

void main() {
    uint id = large_ids[gl_WorkGroupID.x];
    uint item;
    PackedSurfel surfel;
    Disc disc;
    ivec4 box;
    ivec2 home;
    if (!cut_surfel(id, item, surfel) || !view_disc(item, surfel, disc) || !disc_box(disc, box, home)) return;
    for (int y = box.y + int(gl_WorkGroupID.y); y <= box.w; y += int(gl_NumWorkGroups.y))
        for (int x = box.x + int(gl_LocalInvocationID.x); x <= box.z; x += 64)
            take_large_pixel(disc, id, ivec2(x, y), home);
}
