// Splats the queued pairs of surfel and map into the VPLs' imperfect shadow maps (Ritschel et al. 2008): one
// invocation a pair; large discs go to splat_large.comp.
layout(local_size_x = 256) in;

#include "gi/vpl/disc.glsl"

const int kLargeTexels = 32;  // a bit each

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
    if (size.x * size.y > kLargeTexels) {
        large_places[atomicAdd(large_count, 1u)] = place;
        return;
    }
    float offset = disc_offset(disc);
    uint surface = disc_surface(disc);
    // First all texels are tested, then those that are met are written: llvmpipe writes one lane after the other, and few
    // lanes meet theirs in the same step. Loops test at their end, for it runs a body that no lane enters.
    uint met = 0u, bit = 1u;
    ivec2 at = first;
    do {
        if (disc_hit(disc, offset, texel_centre(uvec2(at))) > 0.0) met |= bit;
        bit <<= 1;
        at = at.x < last.x ? at + ivec2(1, 0) : ivec2(first.x, at.y + 1);
    } while (at.y <= last.y);
    do {
        if (met == 0u) break;
        int i = findLSB(met);
        met &= met - 1u;
        int row = int((float(i) + 0.5) / float(size.x));
        take_texel(pair, disc, offset, surface, uvec2(first + ivec2(i - row * size.x, row)));
    } while (met != 0u);
}
