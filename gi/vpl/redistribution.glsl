// What the race (redistribute.comp) and the estimates of all races together (combine.comp) share.
#include "gi/vpl/gather.glsl"

float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }  // Rec. 709

// How likely light that arrives at a surface is to be worth following: its reflectance, with a floor so that nothing
// lit has zero probability.
float reflected_share(Reflectance r) { return max(luminance(r.kd) + r.ks, 0.02); }
