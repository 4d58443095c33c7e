// The slab about the front surface of a pixel, within which discs are blended.
#include "gi/raster/blend_weights.h"
#include "gi/raster/disc.glsl"

uniform uint band_first;  // the rows of the picture that are blended: from band_first to band_end - 1
uniform uint band_end;

struct Slab {
    float depth;   // of the front surface at the pixel, m
    vec3 normal;   // of the front disc as stored: the two sides of a thin wall have opposite normals
    float radius;  // of the front disc, m
    float scale;   // by which depths behind the front surface are multiplied: -1 and 1 are the ends of the slab
};

// Returns the direction of a pixel's ray in the world, scaled so that its depth is 1.
vec3 world_ray(vec2 tangent) {
    return view_forward.xyz + ray_slope(tangent).x * view_right.xyz + ray_slope(tangent).y * view_down.xyz;
}

Slab slab_of(GBufferTexel front, vec2 tangent) {
    Slab slab;
    slab.depth = front.depth;
    slab.normal = decode_octahedral(front.normal);
    if ((front.albedo & kTexelFromBehind) != 0u) slab.normal = -slab.normal;
    slab.radius = unpackHalf2x16(front.material).y;
    // Along rays that meet the surface at a low angle depths differ by more than the distance of the planes.
    slab.scale = max(abs(dot(slab.normal, world_ray(tangent))), 1e-4) / (kSlab * max(slab.radius, 1e-6));
    return slab;
}
