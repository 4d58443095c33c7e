// The VPLs as texels, for loops: llvmpipe fetches those ten times faster than storage.
#include "gi/engines/vpl/lobes.glsl"
#include "gi/engines/vpl/vpl_light.h"

layout(binding = 3) uniform usamplerBuffer vpl_words;  // VplLight[], five texels each

vec4 vpl_word(uint index, uint member) { return uintBitsToFloat(texelFetch(vpl_words, int(5u * index + member))); }
vec4 vpl_position(uint index) { return vpl_word(index, 0u); }
vec4 vpl_normal(uint index) { return vpl_word(index, 1u); }
vec4 vpl_diffuse(uint index) { return vpl_word(index, 2u); }
vec4 vpl_flux(uint index) { return vpl_word(index, 3u); }
vec4 vpl_incident(uint index) { return vpl_word(index, 4u); }

// The directions from VPL `index` to a point that it sees in a unit direction under a cosine, `distance2` away: one for
// every place of its footprint.
Cone vpl_cone(uint index, vec3 direction, float cosine, float distance2) {
    return Cone(direction, footprint_spread(max(vpl_position(index).w / kPi, 1e-12), cosine, distance2));
}

// What a VPL's lobe adds to its radiant intensity over the cosine, W/sr, in a cone of directions away from it.
vec3 vpl_lobe(uint index, vec3 normal, float exponent, Cone away) {
    vec4 incident = vpl_incident(index);
    if (incident.w <= 0.0) return vec3(0.0);
    float cosine = dot(reflect(-incident.xyz, normal), away.axis);
    return vpl_flux(index).xyz * incident.w * widened_lobe(exponent, cosine, away.spread);
}

// Where the shadow map is drawn from: one radius above the surfel, as the reference engine's rays start, above what
// noise and the rims of neighbouring discs put in its way.
vec3 vpl_map_centre(uint index) {
    vec4 normal = vpl_normal(index);
    return vpl_position(index).xyz + normal.xyz * normal.w;
}
