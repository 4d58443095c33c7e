// Tone curves from exposed radiance to the screen, for C++, GLSL and OpenCL C.
#ifndef LUCARNE_GI_SHARED_TONE_CURVE_H
#define LUCARNE_GI_SHARED_TONE_CURVE_H

#include "gi/shared/language.h"
#include "gi/shared/luminance.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

// Narkowicz 2015, "ACES filmic tone mapping curve": a fit of the ACES reference transform, channel by
// channel.
LUCARNE_FN vec3 filmic_curve(vec3 x) {
    return x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f);
}

// Reinhard et al. 2002, "Photographic tone reproduction for digital images", eq. 3, on luminance (Rec. 709).
LUCARNE_FN vec3 reinhard_curve(vec3 x) {
    return x / (1.0f + luminance(x));
}

// Where the compression of highlights begins.
LUCARNE_CONST float kHighlightKnee = 0.4f;

// Compresses exposed radiance above the knee, by its largest channel, so that the hue stays. The slope is 1
// at the knee; above it grows with the logarithm, the slower the larger `compression` is. 0 changes nothing.
LUCARNE_FN vec3 compress_highlights(vec3 x, float compression) {
    float brightest = max(x.x, max(x.y, x.z));
    if (!(compression > 0.0f) || !(brightest > kHighlightKnee)) return x;
    return x * ((kHighlightKnee + log(1.0f + compression * (brightest - kHighlightKnee)) / compression) /
                brightest);
}

// Maps exposed radiance to linear light in [0, 1]. `curve` is a ToneMap (0: filmic, 1: Reinhard, 2: none);
// `compression` is that of compress_highlights().
// NaN and negative values become black.
LUCARNE_FN vec3 tone_curve(vec3 x, uint curve, float compression) {
    // Beyond 10^4 every curve is white; the bound keeps infinity out of the quotients.
    x = vec3(x.x > 0.0f ? min(x.x, 1e4f) : 0.0f, x.y > 0.0f ? min(x.y, 1e4f) : 0.0f,
             x.z > 0.0f ? min(x.z, 1e4f) : 0.0f);
    x = compress_highlights(x, compression);
    if (curve == 0u) x = filmic_curve(x);
    if (curve == 1u) x = reinhard_curve(x);
    return clamp(x, 0.0f, 1.0f);
}

#ifdef __cplusplus
}  // namespace lucarne::gi
#endif
#endif
