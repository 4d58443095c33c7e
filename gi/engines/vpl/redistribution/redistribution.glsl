// What the race (redistribute.comp) and the estimates of all races together (combine.comp) share.
#include "gi/engines/vpl/shading/gather.glsl"
#include "gi/shared/luminance.h"

// How likely light that arrives at a surface is to be worth following: its reflectance, with a floor so that nothing
// lit has zero probability.
float reflected_share(Reflectance r) { return max(luminance(r.kd) + r.ks, 0.02); }

// What VPL `index` sends, W/sr, in a unit direction in which it sees a surface under a cosine. The race cannot tell
// directions within a texel apart (8 / side^2 sr; variance: a twelfth), nor must the lobe.
vec3 raced_intensity(uint index, vec3 direction, float cosine, float distance2) {
    vec4 diffuse = vpl_diffuse(index);
    vec3 intensity = diffuse.xyz;
#ifdef LUCARNE_GLOSSY
    Cone away = vpl_cone(index, direction, cosine, distance2);
    away.spread += 2.0 / (3.0 * float(map_side) * float(map_side));
    intensity += vpl_lobe(index, vpl_normal(index).xyz, diffuse.w, away);
#endif
    return intensity;
}
