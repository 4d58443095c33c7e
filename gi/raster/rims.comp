// Turns the normals of rims (rims.h), one invocation a pixel. Depths and flags are only read, and the normals of texels
// that are seen from behind only written, each by its own thread.
layout(local_size_x = 64) in;
#include "gi/raster/bindings.h"
#include "gi/raster/one_surface.h"
#include "gi/shared/many_threads.glsl"

layout(std430, binding = kBindTexels) buffer Texels { GBufferTexel texels[]; };
uniform CameraView camera;

void main() {
    uint at = thread_number();
    if (at >= camera.width * camera.height) return;
    GBufferTexel texel = texels[at];
    if (texel.depth == 0.0 || (texel.albedo & kTexelFromBehind) == 0u) return;
    ivec2 here = ivec2(int(at % camera.width), int(at / camera.width));
    vec3 ray = normalize(view_ray(camera, vec2(here) + 0.5));
    if (!may_be_rim(texel, ray)) return;
    vec3 place = view_offset(camera, vec2(here) + 0.5, texel.depth);
    float pixel = pixel_height(camera, texel.depth);
    for (uint i = 0u; i < 8u * kRimSteps; ++i) {
        int steps = 1 << int(i / 8u);
        int place_of_nine = int(i % 8u) + (i % 8u < 4u ? 0 : 1);
        ivec2 there = here + steps * (ivec2(place_of_nine % 3, place_of_nine / 3) - 1);
        if (there.x < 0 || there.y < 0 || there.x >= int(camera.width) || there.y >= int(camera.height)) continue;
        GBufferTexel other = texels[uint(there.y) * camera.width + uint(there.x)];
        if (other.depth == 0.0 || (other.albedo & kTexelFromBehind) != 0u) continue;
        vec3 across = view_offset(camera, vec2(there) + 0.5, other.depth) - place;
        if (!is_one_surface(texel, other, across, float(steps) * pixel)) continue;
        texels[at].normal = encode_octahedral(turned_across(stored_normal(texel), ray));
        return;
    }
}
