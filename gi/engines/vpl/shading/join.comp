// Decides the geometry-aware gather: see join.glsl.
layout(local_size_x = 8, local_size_y = 8) in;

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/shading/isolated.h"
#include "gi/engines/vpl/shading/join.glsl"

layout(std430, binding = kBindIsolated) buffer Isolated {  // isolated pixels, which lack too many interleaved tiles
    IsolatedHeader isolated;
    uint isolated_pixels[];
};

// Returns whether the surfaces of two pixels are alike: max(0, n.n')^32 exp(-plane distance / (sigma z)) is at least
// 1/e, one standard width. sigma z is the extent of an n x n window at the depth of the receiver, which is the height
// that a plane tilted by 45 degrees gains over it.
bool alike(vec3 position, vec3 normal, float sigma_z, uvec2 pixel, GBufferTexel texel) {
    vec3 offset = texel_position(camera, pixel, texel) - position;
    float normals = max(dot(normal, texel_normal(texel)), 1e-6);
    return texel.depth > 0.0 && 32.0 * log(normals) - abs(dot(normal, offset)) / sigma_z >= -1.0;
}

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (pixel.x >= camera.width || pixel.y >= camera.height) return;
    uint index = pixel.y * camera.width + pixel.x;
    GBufferTexel texel = camera_texel(index);
    if (texel.depth <= 0.0) return;
    int n = int(interleave);
    vec3 position = texel_position(camera, pixel, texel);
    vec3 normal = texel_normal(texel);
    float sigma_z = float(n) * pixel_height(camera, texel.depth);
    uvec2 joint = uvec2(0u);
    int last = n > 1 ? 3 : 0;
    for (int i = 0; i < n * n; ++i) {
        int j = 0;
        do {
            ivec2 at = window_pixel(ivec2(pixel), n, i, j);
            bool inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, ivec2(camera.width, camera.height)));
            uint other = inside ? uint(at.y) * camera.width + uint(at.x) : index;
            if (inside && alike(position, normal, sigma_z, uvec2(at), camera_texel(other)))
                joint[i >> 3] |= 1u << (4 * (i & 7) + j);
            ++j;
        } while (j <= last);
    }
    joints[index] = joint;
    uint missing = missing_tiles(n, joint);
    if (tiles_lacking(n, missing) > 0) {
        uint place = atomicAdd(isolated.count, 1u);
        isolated_pixels[place] = index;
        if (place % kIsolatedGroup == 0u)
            atomicMax(isolated.groups[0], min(place / kIsolatedGroup + 1u, kMostIsolatedGroups));
    }
}
