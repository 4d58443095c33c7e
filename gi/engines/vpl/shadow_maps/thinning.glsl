// Which surfels enter which maps.
//
// Every splat of a map shall take about the same solid angle, pi splat_angle^2, however far and slanted its surface is:
// then none is finer than the map can show and none coarser. A surfel that much smaller is left out with its whole level
// of detail: it enters where the area that it stands for without finer surfels, lod_area, is at least what a splat
// should cover there. Levels of detail are even samples (octree/convert), so the few that enter close the surface far
// better than as many chosen by chance would; they are drawn larger, for those that did not.
#include "gi/shared/brdf.h"

uniform float splat_angle;

// Discs seen edge-on grow no further than by the root of this.
const float kLeastSlant = 0.1;
const float kLargestSplat = 3.1623;  // 1 / sqrt(kLeastSlant), in splat_angle * distance

// Splats over each direction where a map is thinned. Even patterns leave 1 % open at 3, holes of a texel that
// pull-push closes.
const float kThinnedCover = 4.0;

// m^2 of its surface that a splat at this distance stands for.
float needed_area(float distance2, float slant) {
    return kPi / kThinnedCover * splat_angle * splat_angle * distance2 / max(slant, kLeastSlant);
}

// Radius of the disc that is drawn, of one that enters: its own or, where others were left out, a splat's.
float thinned_radius(float radius, float distance_m, float slant) {
    return max(radius, splat_angle * distance_m * inversesqrt(max(slant, kLeastSlant)));
}
