// Adds a large disc to the sums of the pixels that it covers, by a whole workgroup: eight columns by four rows of pixels
// at a time. The disc is exact, see disc_key.
layout(local_size_x = 8, local_size_y = 4) in;
#include "gi/raster/blend.glsl"

void blend_large(uint id) {
    uint item;
    PackedSurfel surfel;
    Disc disc;
    ivec4 box;
    ivec2 home;
    if (!cut_surfel(id, item, surfel) || !view_disc(item, surfel, disc) || is_small(disc)) return;
    if (!disc_box(disc, box, home)) return;
    box.y = max(box.y, int(band_first));
    box.w = min(box.w, int(band_end) - 1);
    Contribution c = contribution_of(surfel, disc);
    for (int y = box.y + int(gl_LocalInvocationID.y); y <= box.w; y += 4)
        for (int x = box.x + int(gl_LocalInvocationID.x); x <= box.z; x += 8) {
            vec2 pixel = vec2(x, y), tangent = pixel_tangent(pixel);
            float z = disc_depth(disc, tangent), offset;
            vec3 across = vec3(ray_start(tangent) + ray_slope(tangent) * z, z) - disc.centre;
            float weight = disc_weight(dot(across, across) / (disc.radius * disc.radius));
            weight = weight_at(pixel_index(pixel), tangent, z, weight, c, offset);
            if (weight > 0.0) contribute(pixel_index(pixel), weight, offset, c);
        }
}
