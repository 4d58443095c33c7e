// Large discs: a workgroup each, whose invocations share out the texels.
layout(local_size_x = 16) in;

#include "gi/vpl/disc.glsl"

void main() {
    uvec2 pair = pairs[large_places[gl_WorkGroupID.x]];
    Disc disc;
    ivec2 first, last;
    if (!disc_over(pair.y, read_caster(pair.x), disc)) return;
    disc_box(disc, first, last);
    int width = last.x - first.x + 1;
    int texels = width * (last.y - first.y + 1);
    float offset = disc_offset(disc);
    uint surface = disc_surface(disc);
    for (int i = int(gl_LocalInvocationID.x); i < texels; i += 16)
        take_texel(pair, disc, offset, surface, first + ivec2(i % width, i / width));
}
