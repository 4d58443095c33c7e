// The VPLs as texels, for loops: llvmpipe fetches those ten times faster than storage.
#include "gi/shared/brdf.h"
#include "gi/vpl/vpl_light.h"

layout(binding = 3) uniform usamplerBuffer vpl_words;  // VplLight[], five texels each

vec4 vpl_word(uint index, uint member) { return uintBitsToFloat(texelFetch(vpl_words, int(5u * index + member))); }
vec4 vpl_position(uint index) { return vpl_word(index, 0u); }
vec4 vpl_normal(uint index) { return vpl_word(index, 1u); }
vec4 vpl_diffuse(uint index) { return vpl_word(index, 2u); }
vec4 vpl_flux(uint index) { return vpl_word(index, 3u); }
vec4 vpl_incident(uint index) { return vpl_word(index, 4u); }

// What a VPL's lobe adds to its radiant intensity over the cosine, W/sr, in a unit direction.
vec3 vpl_lobe(uint index, vec3 normal, float exponent, vec3 direction) {
    vec4 incident = vpl_incident(index);
    Reflectance source = Reflectance(vec3(0.0), incident.w, exponent);
    return vpl_flux(index).xyz * specular_brdf(source, normal, incident.xyz, direction);
}

// Where the shadow map is drawn from: one radius above the surfel, as the reference engine's rays start, above what
// noise and the rims of neighbouring discs put in its way.
vec3 vpl_map_centre(uint index) {
    vec4 normal = vpl_normal(index);
    return vpl_position(index).xyz + normal.xyz * normal.w;
}
