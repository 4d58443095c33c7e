// The G-buffer as texels of four words (see Buffer::bind_texels for why), read at any place of the picture.
#include "gi/shared/gbuffer.glsl"

layout(binding = 3) uniform usamplerBuffer gbuffer_texels;
uniform CameraView camera;

// What lengths are shares of that look alike from near and far: to the eye; orthographic, where depths depend on nothing
// that is seen, to where an eye of a field of 53 degrees would stand.
float sight_distance(float depth) { return is_parallel(camera) ? 2.0 * length(camera.up.xyz) : depth; }

GBufferTexel texel_at(ivec2 pixel) {
    ivec2 at = clamp(pixel, ivec2(0), ivec2(camera.width, camera.height) - 1);
    uvec4 words = texelFetch(gbuffer_texels, at.y * int(camera.width) + at.x);
    return GBufferTexel(uintBitsToFloat(words.x), words.y, words.z, words.w);
}
