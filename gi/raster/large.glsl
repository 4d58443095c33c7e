// Draws a disc by a whole workgroup: eight columns by four rows of pixels at a time.
layout(local_size_x = 8, local_size_y = 4) in;
#include "gi/raster/splat.glsl"

void draw_large(uint id) {
    uint item;
    PackedSurfel surfel;
    Disc disc;
    ivec4 box;
    ivec2 home;
    if (!cut_surfel(id, item, surfel) || !view_disc(item, surfel, disc) || is_small(disc)) return;
    if (!disc_box(disc, box, home)) return;
    // As in splat.comp: each invocation tests up to 32 pixels of its column, then writes those that the disc may
    // take.
    ivec2 pixel = box.xy + ivec2(gl_LocalInvocationID.xy);
    if (pixel.x > box.z || pixel.y > box.w) return;
    do {
        int start = pixel.y;
        uint taken = 0u, bit = 1u;
        do {
            uint key = disc_key(disc, pixel_tangent(vec2(pixel)), pixel == home);
            if (key != kNoKey && may_take_pixel(vec2(pixel), key)) taken |= bit;
            pixel.y += 4;
            bit <<= 1;
        } while (bit != 0u && pixel.y <= box.w);
        do {
            if (taken == 0u) break;
            ivec2 chosen = ivec2(pixel.x, start + 4 * findLSB(taken));
            taken &= taken - 1u;
            take_pixel(vec2(chosen), disc_key(disc, pixel_tangent(vec2(chosen)), chosen == home), id);
        } while (taken != 0u);
        if (pixel.y > box.w) pixel = ivec2(pixel.x + 8, box.y + int(gl_LocalInvocationID.y));
    } while (pixel.x <= box.z);
}
