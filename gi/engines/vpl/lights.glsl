// Reads the VPLs as texels, for loops: llvmpipe fetches texels ten times faster than storage.
#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/lobes.glsl"
#include "gi/engines/vpl/vpl_light.h"

layout(binding = kUnitLights) uniform usamplerBuffer vpl_words;  // VplLight[], five texels each

vec4 vpl_word(uint index, uint member) { return uintBitsToFloat(texelFetch(vpl_words, int(5u * index + member))); }
vec4 vpl_position(uint index) { return vpl_word(index, 0u); }
vec4 vpl_normal(uint index) { return vpl_word(index, 1u); }
vec4 vpl_diffuse(uint index) { return vpl_word(index, 2u); }
vec4 vpl_flux(uint index) { return vpl_word(index, 3u); }
vec4 vpl_incident(uint index) { return vpl_word(index, 4u); }

// Returns the directions from VPL `index` to a point, one for every place of its footprint. The VPL sees the point in
// a unit direction, under `cosine`, at a squared distance of `distance2`.
Cone vpl_cone(uint index, vec3 direction, float cosine, float distance2) {
    return Cone(direction, footprint_spread(max(vpl_position(index).w / kPi, 1e-12), cosine, distance2));
}

// Returns what a VPL's lobe adds to its radiant intensity over the cosine, W/sr, in a cone of directions away from
// it.
vec3 vpl_lobe(uint index, vec3 normal, float exponent, Cone away) {
    vec4 incident = vpl_incident(index);
    if (incident.w <= 0.0) return vec3(0.0);
    float cosine = dot(reflect(-incident.xyz, normal), away.axis);
    return vpl_flux(index).xyz * incident.w * widened_lobe(exponent, cosine, away.spread);
}

// Returns the centre of projection of the VPL's shadow map: one radius above the surfel, where the rays of the
// reference engine start too, so that noise and the rims of neighbouring discs do not block it.
vec3 vpl_map_centre(uint index) {
    vec4 normal = vpl_normal(index);
    return vpl_position(index).xyz + normal.xyz * normal.w;
}
