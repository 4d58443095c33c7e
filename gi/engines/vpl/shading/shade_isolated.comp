// Shades isolated pixels, which have too few neighbours of their own surface, with the VPLs of the tiles that they
// lack.
#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/shading/isolated.h"
#include "gi/engines/vpl/shading/join.glsl"

layout(std430, binding = kBindIsolated) readonly buffer Isolated {
    IsolatedHeader isolated;
    uint isolated_pixels[];
};
layout(std430, binding = kBindDiffuse) buffer OwnDiffuse { vec4 own_diffuse[]; };
layout(std430, binding = kBindSpecular) buffer OwnSpecular { vec4 own_specular[]; };

layout(local_size_x = kIsolatedGroup) in;

void shade(uint index) {
    uvec2 pixel = uvec2(index % camera.width, index / camera.width);
    Receiver receiver = pixel_receiver(pixel, camera_texel(index));
    int n = int(interleave);
    uint missing = missing_tiles(n, joints[index]);
    int lacking = tiles_lacking(n, missing);
    Gathered sum = Gathered(vec3(0.0), vec3(0.0));
    do {
        Gathered tile = gather_tile(receiver, window_tile(ivec2(pixel), n, findLSB(missing)));
        sum.irradiance += tile.irradiance;
        sum.specular += tile.specular;
        missing &= missing - 1u;
        --lacking;
    } while (lacking > 0);
    own_diffuse[index] += vec4(sum.irradiance, 0.0);
#ifdef LUCARNE_GLOSSY
    own_specular[index] += vec4(sum.specular, 0.0);
#endif
}

void main() {
    uint number = gl_GlobalInvocationID.x;
    if (number >= isolated.count) return;
    do {
        shade(isolated_pixels[number]);
        number += gl_NumWorkGroups.x * kIsolatedGroup;
    } while (number < isolated.count);
}
