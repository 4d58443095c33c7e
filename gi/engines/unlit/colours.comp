// Writes the colour of a pixel times the shade of its shape. Pixels without a point keep the background.
layout(local_size_x = 16, local_size_y = 4) in;
#include "gi/engines/unlit/bindings.h"
#include "gi/engines/unlit/texels.glsl"

layout(std430, binding = kBindRadiance) writeonly buffer Radiance { vec4 radiance[]; };
uniform float strength;
uniform float brightness;
uniform float neighbour;  // distance of the neighbours, pixels

#if defined(LUCARNE_EYE_DOME)
// Boucheny 2009 ("Interactive scientific visualization of large datasets: towards a perceptive-based approach",
// section 3.3): a pixel gets darker the farther its neighbours lie in front of it. Depths are compared by their
// logarithms, so that a scene looks alike from near and far.
const float kEyeDome = 100.0;  // at strength 1; if half the neighbours are nearer by 1 %, the shade is exp(-1.4 / 2)
float shade(ivec2 pixel, GBufferTexel texel) {
    const vec2 kDirections[8] = vec2[](vec2(1.0, 0.0), vec2(0.7071, 0.7071), vec2(0.0, 1.0), vec2(-0.7071, 0.7071),
                                       vec2(-1.0, 0.0), vec2(-0.7071, -0.7071), vec2(0.0, -1.0),
                                       vec2(0.7071, -0.7071));
    float sum = 0.0;
    for (int i = 0; i < 8; ++i) {
        float depth = texel_at(pixel + ivec2(round(neighbour * kDirections[i]))).depth;
        if (depth > 0.0) sum += log2(1.0 + max(texel.depth - depth, 0.0) / sight_distance(depth));
    }
    return exp(-kEyeDome * strength * sum / 8.0);
}
#elif defined(LUCARNE_OCCLUSION)
layout(std430, binding = kBindObscurance) readonly buffer Obscurance { float obscurance[]; };
// The mean obscurance over the 4 x 4 pixels through which occlusion.comp rotates its samples, counting only pixels of
// the same surface.
float shade(ivec2 pixel, GBufferTexel texel) {
    float sum = 0.0, weights = 0.0;
    for (int y = -2; y < 2; ++y)
        for (int x = -2; x < 2; ++x) {
            ivec2 at = clamp(pixel + ivec2(x, y), ivec2(0), ivec2(camera.width, camera.height) - 1);
            float apart = abs(texel_at(at).depth - texel.depth) / sight_distance(texel.depth);
            float weight = max(1.0 - 40.0 * apart, 0.0);  // 0 if more than 2.5 % of the distance apart
            sum += weight * obscurance[at.y * int(camera.width) + at.x];
            weights += weight;
        }
    return pow(clamp(1.0 - sum / max(weights, 1e-6), 0.0, 1.0), strength);
}
#else
float shade(ivec2 pixel, GBufferTexel texel) { return 1.0; }
#endif

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= int(camera.width) || pixel.y >= int(camera.height)) return;
    GBufferTexel texel = texel_at(pixel);
    if (!(texel.depth > 0.0)) return;
    vec3 colour = min(brightness * texel_albedo(texel), vec3(1.0));
    radiance[pixel.y * int(camera.width) + pixel.x] = vec4(colour * shade(pixel, texel), 1.0);
}
