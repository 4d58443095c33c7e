// A pixel of the camera's G-buffer as a receiver, for shading and merging.
#include "gi/engines/vpl/bindings.h"
#include "gi/shared/gbuffer.h"
// A text is inserted where it is first included, so what both branches need comes first.
#include "gi/engines/vpl/shading/receiver.glsl"
#include "gi/engines/vpl/shading/sky_map.h"
#ifdef LUCARNE_SKY
#include "gi/engines/vpl/shading/gather_sky.glsl"
#else
#include "gi/engines/vpl/shading/gather.glsl"
#endif

layout(std430, binding = kBindMaterials) readonly buffer Materials { Material materials[]; };
layout(binding = kUnitGBuffer) uniform usamplerBuffer camera_words;  // GBufferTexel[]

uniform CameraView camera;
uniform uint interleave;   // n
uniform uint light_count;  // M, or the number of directions of the sky

GBufferTexel camera_texel(uint index) {
    uvec4 words = texelFetch(camera_words, int(index));
    return GBufferTexel(uintBitsToFloat(words.x), words.y, words.z, words.w);
}

Receiver pixel_receiver(uvec2 pixel, GBufferTexel texel) {
    Receiver receiver;
    receiver.position = texel_position(camera, pixel, texel);
    receiver.normal = texel_normal(texel);
    receiver.radius = texel_radius(texel);
    receiver.to_viewer = toward_viewer(camera, receiver.position);
    receiver.reflectance = make_reflectance(materials[texel_material(texel)], texel_albedo(texel));
    return receiver;
}

// Returns the estimate of the light of all VPLs, or of the sky, by one tile.
Gathered gather_tile(Receiver receiver, uint tile) {
    uint tiles = interleave * interleave;
    Gathered gathered = gather(receiver, tile, tiles, light_count);
    gathered.irradiance *= float(tiles);
    gathered.specular *= float(tiles);
    return gathered;
}
