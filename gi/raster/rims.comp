// Turns the normals of rims (rims.h), one invocation a pixel. The first pass finds the normals of all texels; the second
// (LUCARNE_APPLY) writes them, so that no texel sees what has become of its neighbours.
layout(local_size_x = 64) in;
#include "gi/raster/bindings.h"
#include "gi/raster/one_surface.h"
#include "gi/shared/many_threads.glsl"

layout(std430, binding = kBindTexels) buffer Texels { GBufferTexel texels[]; };
layout(std430, binding = kBindCoverage) buffer Normals { uint normals[]; };
uniform CameraView camera;

// Returns whether most texels of the surface around a texel show its other side.
bool is_rim(ivec2 here, GBufferTexel texel) {
    vec3 place = view_offset(camera, vec2(here) + 0.5, texel.depth);
    vec3 normal = stored_normal(texel);
    float pixel = pixel_height(camera, texel.depth);
    int others = 0;  // more than those of the same side
    for (uint i = 0u; i < 8u * kRimSteps; ++i) {
        int steps = 1 << int(i / 8u);
        int place_of_nine = int(i % 8u) + (i % 8u < 4u ? 0 : 1);
        ivec2 there = here + steps * (ivec2(place_of_nine % 3, place_of_nine / 3) - 1);
        if (there.x < 0 || there.y < 0 || there.x >= int(camera.width) || there.y >= int(camera.height)) continue;
        GBufferTexel other = texels[uint(there.y) * camera.width + uint(there.x)];
        if (other.depth == 0.0) continue;
        vec3 across = view_offset(camera, vec2(there) + 0.5, other.depth) - place;
        if (!is_one_surface(texel, normal, other, across, float(steps) * pixel)) continue;
        others += ((texel.albedo ^ other.albedo) & kTexelFromBehind) != 0u ? 1 : -1;
    }
    return others > 0;
}

void main() {
    uint at = thread_number();
    if (at >= camera.width * camera.height) return;
#ifdef LUCARNE_APPLY
    texels[at].normal = normals[at];
#else
    GBufferTexel texel = texels[at];
    normals[at] = texel.normal;
    if (texel.depth == 0.0 || (texel.albedo & kSurfelHasNormal) == 0u) return;
    ivec2 here = ivec2(int(at % camera.width), int(at / camera.width));
    vec3 ray = normalize(view_ray(camera, vec2(here) + 0.5));
    if (may_be_rim(texel, ray) && is_rim(here, texel)) normals[at] = encode_octahedral(rim_normal(texel, ray));
#endif
}
