// Combines the estimates of all races; one invocation a new VPL. Any VPL of the bounce before might have placed a new
// VPL here. The joint density is the sum over k of p_k(x). The flux of a new VPL is the irradiance by all old VPLs
// over that density (multiple importance sampling, the balance heuristic; Veach and Guibas 1995), which varies less
// than the estimate of its own race alone. Its footprint is the inverse of the density. A lobe needs one direction of
// light, so it keeps the flux of its own race.
layout(local_size_x = 16) in;

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/redistribution/redistribution.glsl"

layout(std430, binding = kBindLights) buffer Next { VplLight next[]; };
layout(binding = kUnitWeightSums) uniform usamplerBuffer weight_sums;

uniform uint light_count;

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= light_count) return;
    VplLight light = next[index];
    Receiver receiver;
    receiver.position = light.position.xyz;
    receiver.normal = light.normal.xyz;
    receiver.radius = light.normal.w;
    receiver.to_viewer = light.normal.xyz;
    receiver.reflectance = Reflectance(vec3(0.0), 0.0, 1.0);
    vec3 irradiance = vec3(0.0);
    float density = 0.0, own = 0.0;  // 1/m^2: of all races, of its own race
    for (uint i = 0u; i < light_count; ++i) {
        float sum = uintBitsToFloat(texelFetch(weight_sums, int(i)).x);
        vec3 offset = receiver.position - vpl_position(i).xyz;
        float geometry = point_geometry(vpl_normal(i).xyz, offset, receiver);
        if (!(sum > 0.0) || geometry <= 0.0) continue;
        vec3 lifted = offset + receiver.normal * receiver.radius;
        if (i != index && !vpl_sees(i, vpl_normal(i), lifted, receiver.normal)) continue;
        float distance2 = dot(offset, offset);
        vec3 direction = offset * inversesqrt(distance2);
        vec3 intensity = raced_intensity(i, direction, dot(direction, vpl_normal(i).xyz), distance2);
        float chance = luminance(intensity) * geometry / sum;
        density += chance;
        if (i == index) own = chance;
        // VPLs count as points, as in the races. Light from near VPLs is bounded by the density, and discs would send
        // less there.
        irradiance += intensity * geometry;
    }
    // By this rule its own race could not have placed it: it lies in the plane of its parent within the precision of
    // positions, and the side it faces is a guess. On a roof that could be the side of a sealed room, so the VPL is
    // discarded.
    if (!(own > 0.0)) {
        next[index] = VplLight(vec4(vec3(1e18), 0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
        return;
    }
    density *= reflected_share(Reflectance(light.diffuse.xyz * kPi, light.incident.w, 1.0));
    next[index].position.w = 1.0 / density;
#ifdef LUCARNE_BEST_CANDIDATE
    next[index].diffuse.xyz *= light.flux.xyz;
#else
    next[index].diffuse.xyz *= irradiance / density;
#endif
}
