// Phong lobes and the footprints of VPLs as spherical Gaussians: what a lobe reflects of a disc, and what a disc's lobe
// sends, are integrals of their products, which have closed form.
//
// Based on: Hasan, Krivanek, Walter, Bala 2009 (virtual spherical lights: the footprint, not the point, is what is seen,
// and energy is kept); Tokuyoshi 2015 (virtual spherical Gaussian lights: the same without samples).
//
// G(w; a, k) = exp(k (a.w - 1)). A Phong lobe cos^n is one of k = n + 1, of the same integral, and a wider one is taken
// as the Phong lobe of the sharpness that comes out: as the footprint shrinks, the BRDF itself is left.
#include "gi/shared/brdf.h"

// Variance of the Gaussian that stands for a footprint of area A, over that of the disc, r^2/4 an axis: VPLs are about
// sqrt(A) apart, and a sum of Gaussians that far apart is smooth where their standard deviation is .6 of that. It
// shrinks with the frames that are averaged, and the blur with it (lobes.h).
uniform float footprint_variance;

// rad^2 an axis: of the directions from a point to a footprint of squared radius r2, that is seen under a cosine from
// `distance2` away. Of one that is near and wide no more than a hemisphere is left.
float footprint_spread(float r2, float cosine, float distance2) {
    float variance = 0.25 * footprint_variance * r2;
    return variance * cosine / (distance2 + variance);
}

// The mean over directions that spread by `spread` of the lobe (n+2)/(2 pi) cos^n, 1/sr: Gaussians of sharpness n + 1
// and 1/spread convolved, 1/k = 1/(n+1) + spread, with the lobe's integral kept. No lobe is wider than a hemisphere.
float widened_lobe(float exponent, float cosine, float spread) {
    float sharpness = exponent + 1.0;
    float wide = max(sharpness / (1.0 + sharpness * spread), 1.0);
    float height = (exponent + 2.0) / (2.0 * kPi) * wide / sharpness;
    return cosine > 0.0 ? height * pow(min(cosine, 1.0), wide - 1.0) : 0.0;
}

// A cone of directions, as a Gaussian.
struct Cone {
    vec3 axis;     // unit
    float spread;  // rad^2 an axis
};

// The product of a cone and a lobe about `axis`, as a cone: where the light comes from that the lobe reflects.
Cone seen_by_lobe(Cone cone, vec3 axis, float exponent) {
    vec3 sum = cone.axis + axis * (exponent + 1.0) * cone.spread;  // over the cone's sharpness
    float size = max(length(sum), 1e-6);
    return Cone(sum / size, cone.spread / size);
}
