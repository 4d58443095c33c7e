// Adds up, for each cell of the sky's grid, how much light from there adds to the picture: the importance that importons
// send through the texels of their shadow maps that show no surface. One invocation a texel.
layout(local_size_x = 64) in;

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/shadow_maps/parabolic.glsl"
#include "gi/engines/vpl/view_importance/openings.h"
#include "gi/engines/vpl/vpl_light.h"
#include "gi/lighting/sky_grid.h"
#include "gi/shared/luminance.h"
#include "gi/shared/many_threads.glsl"

layout(std430, binding = kBindLights) readonly buffer Importons { VplLight importons[]; };
layout(std430, binding = kBindOpenings) buffer Openings { uint openings[]; };

uniform uint map_count;

// Returns whether the texel and its four neighbours show no surface. Single empty texels are holes between splats.
bool is_open(uint map, ivec2 texel) {
    const ivec2 kAround[5] = ivec2[](ivec2(0, 0), ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1));
    for (int i = 0; i < 5; ++i) {
        ivec2 at = clamp(texel + kAround[i], ivec2(0), ivec2(int(map_side) - 1));
        if (atlas[texel_index(map, uvec2(at))] != kNothing) return false;
    }
    return true;
}

void main() {
    uint at = thread_number();
    uint map = at / (map_side * map_side), texel = at % (map_side * map_side);
    uvec2 place = uvec2(texel % map_side, texel / map_side);
    if (map >= map_count || !is_open(map, ivec2(place))) return;
    vec2 uv = texel_centre(place);
    float stretch = 1.0 + dot(uv, uv);
    vec3 normal = importons[map].normal.xyz;
    if (stretch > 2.0 || dot(normal, normal) == 0.0) return;
    vec3 direction = map_ray(uv) / stretch;
    // d_omega = 4 / (1 + u^2 + v^2)^2 du dv, and a texel is 2 / map_side wide.
    float solid_angle = 16.0 / (stretch * stretch * float(map_side * map_side));
    float importance = luminance(importons[map].diffuse.rgb) * direction.z * solid_angle;
    atomicAdd(openings[sky_cell(normalize(frame_about(normal) * direction))], uint(importance * kOpeningSteps + 0.5));
}
