// Adds a large disc to the sums of the pixels that it covers, by a whole workgroup: eight columns by four rows of pixels
// at a time. The disc is exact (gi/shared/disc.h).
layout(local_size_x = 8, local_size_y = 4) in;
#include "gi/raster/blend.glsl"

void blend_large(uint id) {
    uint item;
    PackedSurfel surfel;
    ViewDisc disc;
    if (!cut_surfel(id, item, surfel) || !view_disc(item, surfel, disc) || is_small(disc)) return;
    DiscBox box = disc_box(disc, disc_picture());
    if (is_empty(box)) return;
    ivec2 first = max(ivec2(box.first), ivec2(0, band_first));
    ivec2 last = min(ivec2(box.last), ivec2(view_width, band_end) - 1);
    Contribution c = contribution_of(surfel, disc);
    for (int y = first.y + int(gl_LocalInvocationID.y); y <= last.y; y += 4)
        for (int x = first.x + int(gl_LocalInvocationID.x); x <= last.x; x += 8) {
            vec2 pixel = vec2(x, y), tangent = pixel_tangent(pixel);
            vec3 start = disc_start(tangent), ray = disc_ray(tangent);
            float z = disc_depth(disc, start, ray), offset;
            vec3 across = start + ray * z - disc.centre;
            float weight = disc_weight(dot(across, across) / (disc.radius * disc.radius));
            if (!within_edge(disc.edge, across)) weight = 0.0;
            weight = weight_at(pixel_index(pixel), tangent, z, weight, c, offset);
            if (weight > 0.0) contribute(pixel_index(pixel), weight, offset, c);
        }
}
