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

// m^2 an axis.
float footprint_gaussian(float r2) { return 0.25 * footprint_variance * r2; }

// rad^2 an axis: of the directions from a point to a footprint of squared radius r2, that is seen under a cosine from
// `distance2` away. Of one that is near and wide no more than a hemisphere is left.
float footprint_spread(float r2, float cosine, float distance2) {
    float variance = footprint_gaussian(r2);
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

// The density, 1/m^2, of a footprint of this variance where a lobe about `axis` meets its plane, from a point `offset` away
// from its middle: the other view of the same integral. Gaussians in the plane: the lobe's section there is
// t^2/k (1 + tan^2 along the slope) wide, and a wide footprint near by gives all the light it has, where the mean over
// directions would look for it in its middle.
float lobe_on_plane(vec3 axis, float exponent, vec3 light_normal, vec3 offset, float variance) {
    float facing = max(-dot(axis, light_normal), 1e-3);
    float t = dot(offset, light_normal) / facing;
    vec3 apart = offset + axis * t;
    vec3 slope = axis / facing + light_normal;
    float section = t * t / (exponent + 1.0);
    float across = variance + section;
    float along = across + section * dot(slope, slope);
    float skew = dot(slope, apart);
    float squares = (dot(apart, apart) - section * skew * skew / along) / across;
    return (exponent + 2.0) / (exponent + 1.0) * exp(-0.5 * squares) / (2.0 * kPi * sqrt(across * along));
}

// What of a VPL's disc of unit radiant intensity a lobe about `axis` sees, 1/m^2, from a point `offset` away whose form
// factor (sr over the disc's area) is known. By directions while the footprint is small beside the lobe; in the plane
// while the lobe is small beside the footprint and does not graze the plane.
float lobe_sees(vec3 axis, float exponent, vec3 normal, vec3 light_normal, vec3 offset, float form_factor, Cone away,
                float variance) {
    float facing = max(-dot(axis, light_normal), 0.0), narrow = 1.0 / (exponent + 1.0);
    float share = away.spread / (away.spread + narrow) * facing * facing / (facing * facing + 4.0 * narrow);
    float by_direction = form_factor * widened_lobe(exponent, -dot(axis, away.axis), away.spread);
    float cosine = max(dot(axis, normal), 0.0);
    float in_plane = cosine * lobe_on_plane(axis, exponent, light_normal, offset, variance);
    return mix(by_direction, in_plane, share);
}
