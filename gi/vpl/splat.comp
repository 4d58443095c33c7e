// Splats the queued pairs of surfel and map into the VPLs' imperfect shadow maps (Ritschel et al. 2008): one
// invocation a pair; large discs go to splat_large.comp.
layout(local_size_x = 256) in;

#include "gi/vpl/disc.glsl"

const int kLargeTexels = 48;

void main() {
    uint place = gl_GlobalInvocationID.x;
    if (place >= pair_count) return;
    uvec2 pair = pairs[place];
    Disc disc;
    if (!disc_over(pair.y, read_caster(pair.x), disc)) return;
    ivec2 first, last;
    disc_box(disc, first, last);
    if (first.x > last.x || first.y > last.y) return;
    ivec2 size = last - first + 1;
    if (size.x * size.y > kLargeTexels && queue_large(place)) return;
    float offset = disc_offset(disc);
    uint surface = disc_surface(disc);
    // One loop for both axes: neighbours with smaller discs wait less.
    for (ivec2 at = first; at.x <= last.x; at = at.y < last.y ? at + ivec2(0, 1) : ivec2(at.x + 1, first.y))
        take_texel(pair, disc, offset, surface, at);
}
