// Decides which surfels are drawn into which maps.
//
// Every splat of a map shall cover about the same solid angle, pi splat_angle^2, however far and slanted its surface
// is: then no splat is finer than the map can show, and none is coarser. Surfels that are much smaller are left out
// together with their whole level of detail. A surfel is drawn if lod_area, the area that it stands for without finer
// surfels, is at least what a splat should cover there. Levels of detail are even samples (octree/convert), so the
// few surfels that are drawn close the surface far better than as many chosen at random; they are drawn larger, to
// stand in for the others.
#include "gi/engines/vpl/shadow_maps/splats.h"

uniform float splat_angle;

// Returns the area of its surface, m^2, that a splat at this distance stands for.
float needed_area(float distance2, float slant) {
    return thinned_area(splat_angle) * distance2 / max(slant, kLeastSlant);
}

// Returns the radius of the disc that is drawn for a surfel: its own or, where others are left out, that of a splat.
float thinned_radius(float radius, float distance_m, float slant) {
    return max(radius, splat_angle * distance_m * inversesqrt(max(slant, kLeastSlant)));
}
