// Draws a disc by a whole workgroup: eight columns by four rows of pixels at a time.
layout(local_size_x = 8, local_size_y = 4) in;
#include "gi/raster/splat.glsl"

uint key_at(ViewDisc disc, ivec2 pixel, ivec2 home) {
    vec2 tangent = pixel_tangent(vec2(pixel));
    return disc_key(disc, disc_start(tangent), disc_ray(tangent), view_forward.w, pixel == home);
}

void draw_large(uint id) {
    uint item;
    PackedSurfel surfel;
    ViewDisc disc;
    if (!cut_surfel(id, item, surfel) || !view_disc(item, surfel, disc) || is_small(disc)) return;
    DiscBox box = disc_box(disc, disc_picture());
    if (is_empty(box)) return;
    ivec2 first = ivec2(box.first), last = ivec2(box.last), home = ivec2(box.home);
    // As in splat.comp: each invocation tests up to 32 pixels of its column, then writes those that the disc may
    // take.
    ivec2 pixel = first + ivec2(gl_LocalInvocationID.xy);
    if (pixel.x > last.x || pixel.y > last.y) return;
    do {
        int start = pixel.y;
        uint taken = 0u, bit = 1u;
        do {
            uint key = key_at(disc, pixel, home);
            if (key != kNoKey && may_take_pixel(vec2(pixel), key)) taken |= bit;
            pixel.y += 4;
            bit <<= 1;
        } while (bit != 0u && pixel.y <= last.y);
        do {
            if (taken == 0u) break;
            ivec2 chosen = ivec2(pixel.x, start + 4 * findLSB(taken));
            taken &= taken - 1u;
            take_pixel(vec2(chosen), key_at(disc, chosen, home), id);
        } while (taken != 0u);
        if (pixel.y > last.y) pixel = ivec2(pixel.x + 8, first.y + int(gl_LocalInvocationID.y));
    } while (pixel.x <= last.x);
}
