// Splats the queued pairs of surfel and map into the imperfect shadow maps of the VPLs (Ritschel et al. 2008): one
// invocation a pair. Large discs go to splat_large.comp.
#include "gi/engines/vpl/shadow_maps/disc.glsl"

layout(local_size_x = kSplatGroup) in;

const int kLargeTexels = 32;  // one bit each

// Returns the texel of the lowest bit, in a box that begins at `first`.
uvec2 first_of(uint bits, ivec2 first, int width) {
    int i = findLSB(bits);
    int row = int((float(i) + 0.5) / float(width));
    return uvec2(first + ivec2(i - row * width, row));
}

float distance_at(MapDisc disc, uvec2 at) {
    vec2 uv = texel_centre(at);
    return meet_disc(disc.centre, disc.normal, map_ray(uv)).t * (1.0 + dot(uv, uv));
}

void main() {
    uint place = gl_GlobalInvocationID.x;
    if (place >= queues[queue].pair_count) return;
    uvec2 pair = pairs[place];
    MapDisc disc;
    if (!disc_over(pair.y, read_caster(pair.x), disc)) return;
    ivec2 first, last;
    map_box(disc, first, last);
    if (first.x > last.x || first.y > last.y) return;
    ivec2 size = last - first + 1;
    if (size.x * size.y > kLargeTexels) {
        large_places[atomicAdd(queues[queue].large_count, 1u)] = place;
        return;
    }
    uint surface = disc_surface(disc);
    // First all texels are tested, then those that the disc covers are written: llvmpipe writes one lane after the
    // other, and few lanes cover a texel in the same step. Loops test at their end, because llvmpipe runs a loop body
    // even if no lane enters it.
    uint core = 0u, rest = 0u, bit = 1u;
    ivec2 at = first;
    do {
        Hit hit = map_hit(disc, texel_centre(uvec2(at)));
        if (hit.t > 0.0 && hit.core) core |= bit;
        if (hit.t > 0.0 && !hit.core) rest |= bit;
        bit <<= 1;
        at = at.x < last.x ? at + ivec2(1, 0) : ivec2(first.x, at.y + 1);
    } while (at.y <= last.y);
    do {
        if (core == 0u) break;
        uvec2 texel = first_of(core, first, size.x);
        take_core(pair, texel_index(pair.y, texel), distance_at(disc, texel), surface);
        core &= core - 1u;
    } while (core != 0u);
    do {
        if (rest == 0u) break;
        uvec2 texel = first_of(rest, first, size.x);
        take_fringe(pair, texel_index(pair.y, texel), distance_at(disc, texel), surface);
        rest &= rest - 1u;
    } while (rest != 0u);
}
