// The G-buffer as texels of four words (see Buffer::bind_texels for why), read at any place of the picture.
#include "gi/shared/gbuffer.glsl"

layout(binding = 3) uniform usamplerBuffer gbuffer_texels;
uniform CameraView camera;

GBufferTexel texel_at(ivec2 pixel) {
    ivec2 at = clamp(pixel, ivec2(0), ivec2(camera.width, camera.height) - 1);
    uvec4 words = texelFetch(gbuffer_texels, at.y * int(camera.width) + at.x);
    return GBufferTexel(uintBitsToFloat(words.x), words.y, words.z, words.w);
}
