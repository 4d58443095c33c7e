// Runs of kClusterLights VPLs (neighbours in the light's view) and the spheres about them, by which a surfel finds
// the maps that it may enter without asking every VPL.
#include "gi/vpl/vpl_light.h"

layout(std430, binding = 9) readonly buffer Lights { VplLight lights[]; };
layout(std430, binding = 5) buffer Clusters { vec4 clusters[]; };  // xyz: centre; w: radius, m; < 0: all are dead

uniform uint maps;

const uint kClusterLights = 8u;

bool is_alive(VplLight light) { return light.normal.xyz != vec3(0.0); }
