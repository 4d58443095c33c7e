// Interleaved shading (Keller and Heidrich 2001; Preiner 2010, section 4.4). Pixel (x, y) belongs to the interleaved
// tile (x mod n, y mod n) and is lit by the share of the VPLs of that tile alone, n^2 times as strong, so that
// every n has the same mean. VPLs lie in the order of a curve through the light view; every n^2-th of them is an even
// sample. A workgroup shades pixels of one tile, so its invocations read the same VPLs at the same time.
layout(local_size_x = 8, local_size_y = 8) in;

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/shading/pixel.glsl"

layout(std430, binding = kBindDiffuse) buffer DiffuseLight { vec4 diffuse_light[]; };    // irradiance, W/m^2
layout(std430, binding = kBindSpecular) buffer SpecularLight { vec4 specular_light[]; };  // radiance, W/(sr m^2)

void main() {
    uint tile = gl_GlobalInvocationID.z;
    uvec2 pixel = gl_GlobalInvocationID.xy * interleave + uvec2(tile % interleave, tile / interleave);
    if (pixel.x >= camera.width || pixel.y >= camera.height) return;
    uint index = pixel.y * camera.width + pixel.x;
    GBufferTexel texel = camera_texel(index);
    if (texel.depth <= 0.0) return;
    Gathered gathered = gather_tile(pixel_receiver(pixel, texel), tile);
    diffuse_light[index] += vec4(gathered.irradiance, 0.0);
#ifdef LUCARNE_GLOSSY
    specular_light[index] += vec4(gathered.specular, 0.0);
#endif
}
