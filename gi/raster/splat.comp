// Draws small discs pixel by pixel, one invocation each. The first pass goes through the cut, queues large discs for
// splat_large.comp and lists the small discs that were nearest in some pixel when they were drawn. The second pass
// (LUCARNE_ID_PASS, see take_pixel) goes through that list, a fraction of the cut.
#include "gi/raster/bindings.h"
#include "gi/raster/ellipse.glsl"
#include "gi/raster/splat.glsl"

layout(local_size_x = kCandidateGroup) in;

layout(std430, binding = kBindCandidates) buffer Candidates { uint candidates[]; };

// Returns the order of the disc at an offset, see disc_key. In the pixel of its centre, if the disc does not cover it
// (seen edge-on, or smaller than a pixel), the order is that of the depth of its centre, pushed back like a rim.
uint ellipse_key(ViewDisc disc, Ellipse e, vec2 d) {
    precise float distance2 = ellipse_distance2(e, d);
    precise float slope = e.slope.x * d.x + e.slope.y * d.y;
    precise float key = disc.centre.z + (distance2 <= 1.0 ? slope + disc.push * distance2 : disc.push);
    return floatBitsToUint(key);
}

// Returns whether the disc took a pixel.
bool draw_small(ViewDisc disc, uint id) {
    Ellipse e = project(disc);
    vec2 home = floor(e.centre + 0.5);
    float determinant = max(e.xx * e.yy - 0.25 * e.xy * e.xy, 1e-12);
    vec2 reach = min(sqrt(vec2(e.yy, e.xx) / determinant), vec2(kSmallRadius + 1.0));
    vec2 low = max(min(ceil(e.centre - reach), home), vec2(0.0));
    vec2 high = min(max(floor(e.centre + reach), home), vec2(view_width, view_height) - 1.0);
    if (low.x > high.x || low.y > high.y) return false;
    float columns = high.x - low.x + 1.0;
    // First up to 32 pixels are tested, then those that the disc may take are written: llvmpipe writes one lane after
    // the other, and few lanes take a pixel in the same step of the loop. Loops test at their end, because llvmpipe
    // runs a loop body even if no lane enters it.
    vec2 pixel = low;
    bool took = false;
    do {
        vec2 start = pixel;
        uint taken = 0u, bit = 1u;
        do {
            vec2 d = pixel - e.centre;
            bool covered = ellipse_distance2(e, d) <= 1.0 && dot(e.edge, d) <= 1.0 || pixel == home;
            if (covered && may_take_pixel(pixel, ellipse_key(disc, e, d))) taken |= bit;
            pixel = pixel.x < high.x ? vec2(pixel.x + 1.0, pixel.y) : vec2(low.x, pixel.y + 1.0);
            bit <<= 1;
        } while (bit != 0u && pixel.y <= high.y);
        do {
            if (taken == 0u) break;
            float column = start.x - low.x + float(findLSB(taken));
            taken &= taken - 1u;
            float row = floor((column + 0.5) / columns);
            vec2 chosen = vec2(low.x + column - row * columns, start.y + row);
            if (take_pixel(chosen, ellipse_key(disc, e, chosen - e.centre), id)) took = true;
        } while (taken != 0u);
    } while (pixel.y <= high.y);
    return took;
}

void main() {
    uint id = gl_GlobalInvocationID.x;
#ifdef LUCARNE_ID_PASS
    if (id >= queues.candidate_count) return;
    id = candidates[id];
#endif
    uint item;
    PackedSurfel surfel;
    ViewDisc disc;
    if (!cut_surfel(id, item, surfel) || !view_disc(item, surfel, disc)) return;
#ifdef LUCARNE_ID_PASS
    draw_small(disc, id);
#else
    if (is_small(disc)) {
        if (draw_small(disc, id)) candidates[atomicAdd(queues.candidate_count, 1u)] = id;
        return;
    }
    uint place = atomicAdd(queues.large_count, 1u);
    if (place < kLargeQueue) large_ids[place] = id;
#endif
}
