// Reads the G-buffer as texels of four words (Buffer::bind_texels says why), at any place of the picture.
#include "gi/engines/unlit/bindings.h"
#include "gi/shared/gbuffer.h"

layout(binding = kUnitTexels) uniform usamplerBuffer gbuffer_texels;
uniform CameraView camera;

// Returns the distance of which lengths are shares, so that a scene looks alike from near and far: the distance to
// the eye. In an orthographic view, where depth says nothing about the picture, it is the distance of an eye with a
// field of view of 53 degrees.
float sight_distance(float depth) { return is_parallel(camera) ? 2.0 * length(camera.up.xyz) : depth; }

GBufferTexel texel_at(ivec2 pixel) {
    ivec2 at = clamp(pixel, ivec2(0), ivec2(camera.width, camera.height) - 1);
    uvec4 words = texelFetch(gbuffer_texels, at.y * int(camera.width) + at.x);
    return GBufferTexel(uintBitsToFloat(words.x), words.y, words.z, words.w);
}
