// Which surfels enter which maps.
//
// A surfel of radius r, seen from a VPL at distance d at the angle a to its normal, has the share
//   q = (r / (splat_angle d))^2 cos a
// of a splat's solid angle. Where q < 1 it is smaller than a splat should be: it enters the VPL's map with probability
// kThinnedCover q alone, but with a disc of radius r / sqrt(q), for the surfels that did not. All splats of a map thus
// take about the same solid angle, pi splat_angle^2, however far and slanted their surface is: none is coarser than
// the map can show, and none finer. Neither a flat share of the surfels for every map does that (coarse splats where
// they are close) nor all of them (256M splats a frame).

uniform float splat_angle;

// Discs seen edge-on grow no further than by the root of this.
const float kLeastSlant = 0.1;
const float kLargestSplat = 3.1623;  // 1 / sqrt(kLeastSlant), in splat_angle * distance

// Surfels' discs cover their surface 5 to 7 times (octree/footprint.h); those of the thinned need not: random discs
// leave e^-C of the rays through, 2 % at 4, most of them holes of one texel that pull-push closes.
const float kThinnedCover = 0.75;

// q. `along` is |dot(normal, offset)|.
float splat_share(float radius, float distance2, float along) {
    float inverse = inversesqrt(distance2);
    float share = radius * inverse / splat_angle;
    return share * share * max(along * inverse, kLeastSlant);
}
