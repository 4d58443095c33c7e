// Which surfels enter which maps.
//
// A surfel of radius r enters the map of a VPL at distance d, which sees it at the angle a to its normal, with
// probability
//   p = min(1, (r / (splat_angle d))^2 cos a),
// and where it does it stands for the 1/p surfels that did not, so that its disc grows to r / sqrt(p). All splats of
// a map thus take about the same solid angle, pi splat_angle^2, however far and slanted their surface is: none is
// coarser than the map can show, and none finer. Neither a flat share of the surfels for every map does that (coarse
// splats where they are close) nor all of them (256M splats a frame).

uniform float splat_angle;

// Discs seen edge-on grow no further than by the root of this.
const float kLeastSlant = 0.1;
const float kLargestSplat = 3.1623;  // 1 / sqrt(kLeastSlant), in splat_angle * distance

// p, and not cut at 1. `along` is |dot(normal, offset)|.
float entry_share(float radius, float distance2, float along) {
    float inverse = inversesqrt(distance2);
    float share = radius * inverse / splat_angle;
    return share * share * max(along * inverse, kLeastSlant);
}
