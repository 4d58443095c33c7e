// Closes the holes between the cores of splats with their fringes. A texel takes its fringe if, at two opposite sides
// a texel or two away, there are cores that belong to the sheet of the fringe or lie in front of it. Nothing is drawn
// below the horizon; surfaces are assumed to continue there. The result replaces the fringe buffer.
layout(local_size_x = 8, local_size_y = 8) in;

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/shadow_maps/fringe.glsl"
#include "gi/engines/vpl/shadow_maps/parabolic.glsl"
#include "gi/engines/vpl/shadow_maps/splats.h"

layout(binding = kUnitAtlas) uniform usamplerBuffer cores;  // the atlas
#ifdef LUCARNE_SOURCES
layout(std430, binding = kBindSources) readonly buffer Sources { uint sources[]; };  // sources.glsl
#endif

vec3 map_point(ivec2 at, uint texel) {
    vec2 uv = texel_centre(uvec2(at));
    return map_ray(uv) * (map_distance(texel) / (1.0 + dot(uv, uv)));
}

// Returns whether the texel at `other`, inside the map, continues the sheet of a fringe at `point`: it is as near, or
// it lies on the plane of the fringe (near the horizon that plane recedes by its own distance within a texel).
bool goes_on(uint map, ivec2 other, uint own, vec3 point) {
    uint texel = texelFetch(cores, int(texel_index(map, uvec2(other)))).x;
    if (texel == kNothing) return false;
    float own_distance = map_distance(own);
    if (map_distance(texel) <= own_distance + 2.0 * splat_radius(map_radius(own), own_distance)) return true;
    vec3 offset = map_point(other, texel) - point;
    return abs(dot(map_normal(own), offset)) <= kNormalError * length(offset) + map_tolerance(map_radius(own), own_distance);
}

bool supported(uint map, ivec2 at, uint own) {
    vec3 point = map_point(at, own);
    for (int axis = 0; axis < kSupportAxes; ++axis) {
        int sides = 0;
        for (int sign = -1; sign <= 1; sign += 2) {
            bool met = false;
            for (int step = 1; step <= kSupportReach && !met; ++step) {
                ivec2 other = at + sign * step * support_axis(axis);
                vec2 uv = texel_centre(uvec2(max(other, ivec2(0))));
                met = min(other.x, other.y) < 0 || dot(uv, uv) >= 1.0 || goes_on(map, other, own, point);
            }
            if (met) ++sides;
        }
        if (sides == 2) return true;
    }
    return false;
}

void main() {
    uvec2 at = gl_GlobalInvocationID.xy;
    uint map = gl_GlobalInvocationID.z;
    if (max(at.x, at.y) >= map_side) return;
    uint index = texel_index(map, at);
    uint core = texelFetch(cores, int(index)).x, own = fringe[index];
    if (own < core && supported(map, ivec2(at), own)) return;
    fringe[index] = core;
#ifdef LUCARNE_SOURCES
    fringe_sources[index] = sources[index];
#endif
}
