// Shared by the kernels that blend discs: how a disc contributes to a pixel. After the method of Botsch, Hornung,
// Zwicker & Kobbelt 2005, "High-quality surface splatting on today's GPUs": all discs within a slab about the front
// surface contribute to the weighted mean of its depth, normal and colour.
#include "gi/raster/bindings.h"
#include "gi/raster/blend_sums.h"
#include "gi/raster/blend_weights.h"
#include "gi/raster/slab.glsl"

layout(std430, binding = kBindSums) buffer Sums { uint sums[]; };  // kSumWords a pixel of the band
layout(binding = kUnitFront) uniform usamplerBuffer front_texels;  // GBufferTexel of the front surface

// The part of a disc that is the same in all pixels.
struct Contribution {
    vec3 normal;   // in the world, as stored: the two sides of a thin wall have opposite normals
    vec3 colour;   // linear
    uint flags;    // kSurfelHasNormal
    uint material;
    float radius;  // m
};

// Returns the weight of a disc at (distance / radius)^2 from its centre: close to exp(-3 d^2), and 0 at the rim.
// That is a Gaussian of half the spacing of the points: as wide as it may be without blurring what they resolve.
float disc_weight(float distance2) {
    float rest = max(1.0 - distance2, 0.0);
    return rest * rest * rest;
}

Contribution contribution_of(PackedSurfel surfel, ViewDisc disc) {
    Contribution c;
    c.flags = surfel.d & kSurfelHasNormal;
    // Surfels without a normal face the viewer.
    c.normal = c.flags != 0u ? surfel_normal(surfel) : -normalize(world_ray(disc.centre.xy / disc.centre.z));
    c.colour = decode_albedo(surfel.d);
    c.material = surfel_material(surfel.b);
    c.radius = disc.radius;
    return c;
}

// Returns the weight with which a disc of depth z contributes to a pixel, from its weight in the disc; sets `offset` to
// its distance behind the front surface as a share of the slab, from -1 to 1.
float weight_at(uint pixel, vec2 tangent, float z, float weight, Contribution c, out float offset) {
    uvec4 words = texelFetch(front_texels, int(pixel));
    Slab slab = slab_of(GBufferTexel(uintBitsToFloat(words.x), words.y, words.z, words.w), tangent);
    offset = (z - slab.depth) * slab.scale;
    bool alike = words.x != 0u && (words.w & 0xffffu) == c.material && (words.z & kSurfelHasNormal) == c.flags &&
                 abs(offset) <= 0.5 + 0.5 * min(c.radius / slab.radius, 1.0);
    weight *= clamp((dot(slab.normal, c.normal) - kCosCrease) / (kCosSmooth - kCosCrease), 0.0, 1.0);
    return alike && weight >= kLeastWeight ? weight : 0.0;
}

// Adds a disc to the sums of a pixel. The sums are integers, so their order does not matter.
void contribute(uint pixel, float weight, float offset, Contribution c) {
    float w = floor(weight * kWeightSteps + 0.5);
    uint at = (pixel - band_first * view_width) * kSumWords;
    vec3 normal = 0.5 * c.normal + 0.5;
    atomicAdd(sums[at], uint(w));
    atomicAdd(sums[at + 1u], uint(w * floor(c.colour.x * kValueSteps + 0.5)));
    atomicAdd(sums[at + 2u], uint(w * floor(c.colour.y * kValueSteps + 0.5)));
    atomicAdd(sums[at + 3u], uint(w * floor(c.colour.z * kValueSteps + 0.5)));
    atomicAdd(sums[at + 4u], uint(w * floor(normal.x * kValueSteps + 0.5)));
    atomicAdd(sums[at + 5u], uint(w * floor(normal.y * kValueSteps + 0.5)));
    atomicAdd(sums[at + 6u], uint(w * floor(normal.z * kValueSteps + 0.5)));
    atomicAdd(sums[at + 7u], uint(w * floor((0.5 * offset + 0.5) * kValueSteps + 0.5)));
}
