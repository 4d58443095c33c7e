// Phong lobes and the footprints of VPLs as spherical Gaussians. What a lobe reflects of a disc, and what the lobe of
// a disc sends, are integrals of products of Gaussians, which have closed form.
//
// Based on: Hasan, Krivanek, Walter, Bala 2009 (virtual spherical lights: a receiver sees the footprint, not the
// point, and energy is kept); Tokuyoshi 2015 (virtual spherical Gaussian lights: the same without samples).
//
// G(w; a, k) = exp(k (a.w - 1)). A Phong lobe cos^n becomes the Gaussian of k = n + 1 with the same integral. A
// widened Gaussian becomes the Phong lobe of its sharpness again, so that the BRDF itself remains as the footprint
// shrinks.
#include "gi/shared/brdf.h"

// Variance of the Gaussian that stands for a footprint of area A, over that of the disc, r^2/4 per axis. VPLs are
// about sqrt(A) apart, and a sum of Gaussians that far apart is smooth if their standard deviation is .6 of that. The
// variance shrinks with the number of averaged frames, and the blur with it (lobes.h).
uniform float footprint_variance;

// Returns the variance of the footprint, m^2 per axis.
float footprint_gaussian(float r2) { return 0.25 * footprint_variance * r2; }

// Returns the variance, rad^2 per axis, of the directions from a point to a footprint of squared radius r2, seen
// under `cosine` from a squared distance of `distance2`. A footprint that is near and wide fills no more than a
// hemisphere.
float footprint_spread(float r2, float cosine, float distance2) {
    float variance = footprint_gaussian(r2);
    return variance * cosine / (distance2 + variance);
}

// Returns the mean, over directions of variance `spread`, of the lobe (n+2)/(2 pi) cos^n, 1/sr. It is the convolution
// of Gaussians of sharpness n + 1 and 1/spread, 1/k = 1/(n+1) + spread, which keeps the integral of the lobe. No lobe
// is wider than a hemisphere.
float widened_lobe(float exponent, float cosine, float spread) {
    float sharpness = exponent + 1.0;
    float wide = max(sharpness / (1.0 + sharpness * spread), 1.0);
    float height = (exponent + 2.0) / (2.0 * kPi) * wide / sharpness;
    return cosine > 0.0 ? height * pow(min(cosine, 1.0), wide - 1.0) : 0.0;
}

// A cone of directions, as a Gaussian.
struct Cone {
    vec3 axis;     // unit
    float spread;  // variance, rad^2 per axis
};

// Returns the product of a cone and a lobe about `axis`, as a cone: the directions of the light that the lobe
// reflects.
Cone seen_by_lobe(Cone cone, vec3 axis, float exponent) {
    vec3 sum = cone.axis + axis * (exponent + 1.0) * cone.spread;  // over the cone's sharpness
    float size = max(length(sum), 1e-6);
    return Cone(sum / size, cone.spread / size);
}

// Returns the density, 1/m^2, of a footprint of this variance where a lobe about `axis` meets its plane, seen from a
// point `offset` away from its middle. This is the same integral in the plane: the section of the lobe there has the
// variance t^2/k (1 + tan^2 along the slope). A wide footprint near by gives all the light it has, while the mean
// over directions would look for that light in its middle.
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

// Returns what a lobe about `axis` sees of a VPL's disc of unit radiant intensity, 1/m^2, from a point `offset` away
// whose form factor (sr over the disc's area) is known. It is computed over directions while the footprint is small
// beside the lobe, and in the plane while the lobe is small beside the footprint and does not graze the plane.
float lobe_sees(vec3 axis, float exponent, vec3 normal, vec3 light_normal, vec3 offset, float form_factor, Cone away,
                float variance) {
    float facing = max(-dot(axis, light_normal), 0.0), narrow = 1.0 / (exponent + 1.0);
    float share = away.spread / (away.spread + narrow) * facing * facing / (facing * facing + 4.0 * narrow);
    float by_direction = form_factor * widened_lobe(exponent, -dot(axis, away.axis), away.spread);
    float cosine = max(dot(axis, normal), 0.0);
    float in_plane = cosine * lobe_on_plane(axis, exponent, light_normal, offset, variance);
    return mix(by_direction, in_plane, share);
}
