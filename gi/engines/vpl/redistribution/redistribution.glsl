// Shared by the race (redistribute.comp) and the combination of all races (combine.comp).
#include "gi/engines/vpl/shading/gather.glsl"
#include "gi/shared/luminance.h"

// Returns how likely it is that light arriving at a surface is worth following: its reflectance, with a floor so that
// nothing lit has zero probability.
float reflected_share(Reflectance r) { return max(luminance(r.kd) + r.ks, 0.02); }

// Returns what VPL `index` sends, W/sr, in a unit direction in which it sees a surface under `cosine`. The race
// cannot tell directions within a texel apart (8 / side^2 sr; variance: a twelfth of that), so the lobe is widened by
// as much.
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
