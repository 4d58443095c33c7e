// Adds the small discs to the sums of the pixels that they cover, one invocation a disc and a workgroup a block.
// Only blocks of which a disc took a pixel are drawn; the others are hidden.
#include "gi/raster/blend.glsl"
#include "gi/raster/ellipse.glsl"
#include "gi/raster/queues.h"

layout(local_size_x = kBlockSurfels) in;

layout(std430, binding = kBindBlocks) readonly buffer Blocks { uint seen_blocks[]; };
layout(std430, binding = kBindQueues) readonly buffer Queues { QueueHeader queues; };
uniform uint blocks;  // of the cut

// Widens the ellipse by a reach in pixels: an elliptical Gaussian convolved with a round one is elliptical (Heckbert
// 1989, "Fundamentals of texture mapping and image warping", section 3.5). So points that are smaller than a pixel
// fade from one pixel to the next where they would jump.
Ellipse widened(Ellipse e, float reach) {
    float determinant = max(e.xx * e.yy - 0.25 * e.xy * e.xy, 1e-12);
    vec3 spread = vec3(e.yy, -0.5 * e.xy, e.xx) / determinant + reach * reach * vec3(1.0, 0.0, 1.0);
    float inverse = 1.0 / (spread.x * spread.z - spread.y * spread.y);
    e.xx = spread.z * inverse;
    e.xy = -2.0 * spread.y * inverse;
    e.yy = spread.x * inverse;
    return e;
}

void blend_small(ViewDisc disc, Contribution c) {
    Ellipse e = widened(project(disc), kPixelReach);
    float determinant = max(e.xx * e.yy - 0.25 * e.xy * e.xy, 1e-12);
    vec2 reach = min(sqrt(kLeastWeightAt * vec2(e.yy, e.xx) / determinant), vec2(kSmallRadius + 2.0));
    vec2 low = max(ceil(e.centre - reach), vec2(0.0, band_first));
    vec2 high = min(floor(e.centre + reach), vec2(view_width, band_end) - 1.0);
    if (low.x > high.x || low.y > high.y) return;
    vec2 pixel = low;
    do {
        vec2 d = pixel - e.centre;
        float weight = dot(e.edge, d) <= 1.0 ? disc_weight(ellipse_distance2(e, d)) : 0.0, offset;
        uint at = pixel_index(pixel);
        // The plane of a disc that is seen edge-on could lie anywhere; that of a widened one reaches over its rim.
        float z = disc.centre.z + clamp(dot(e.slope, d), -2.0 * disc.radius, 2.0 * disc.radius);
        weight = weight_at(at, pixel_tangent(pixel), z, weight, c, offset);
        if (weight > 0.0) contribute(at, weight, offset, c);
        pixel = pixel.x < high.x ? vec2(pixel.x + 1.0, pixel.y) : vec2(low.x, pixel.y + 1.0);
    } while (pixel.y <= high.y);
}

void main() {
    uint place = gl_WorkGroupID.x + gl_WorkGroupID.y * kGroupRow;
    if (place >= queues.seen_count) return;
    uint id = seen_blocks[blocks + place] * kBlockSurfels + gl_LocalInvocationID.x;
    uint item;
    PackedSurfel surfel;
    ViewDisc disc;
    if (!cut_surfel(id, item, surfel) || !view_disc(item, surfel, disc) || !is_small(disc)) return;
    blend_small(disc, contribution_of(surfel, disc));
}
