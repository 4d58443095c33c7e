// Where more discs are large than the queue holds: a group a block of the cut draws all of the block's, one after the
// other.
layout(local_size_x = 64) in;
#include "gi/gbuffer/splat.glsl"

void main() {
    for (uint place = 0u; place < kBlockSurfels; ++place) {
        uint id = gl_WorkGroupID.x * kBlockSurfels + place;
        uint item;
        PackedSurfel surfel;
        Disc disc;
        ivec4 box;
        ivec2 home;
        if (!cut_surfel(id, item, surfel)) return;
        if (!view_disc(item, surfel, disc) || is_small(disc) || !disc_box(disc, box, home)) continue;
        for (int y = box.y; y <= box.w; ++y)
            for (int x = box.x + int(gl_LocalInvocationID.x); x <= box.z; x += 64)
                take_large_pixel(disc, id, ivec2(x, y), home);
    }
}
