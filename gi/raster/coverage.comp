// Finds how much of each pixel at an edge shows the surfaces of its neighbours (coverage.h), one invocation a pixel.
layout(local_size_x = 64) in;
#include "gi/raster/bindings.h"
#include "gi/raster/coverage_code.h"
#include "gi/raster/disc.glsl"
#include "gi/raster/one_surface.h"
#include "gi/shared/many_threads.glsl"

layout(std430, binding = kBindIds) readonly buffer Ids { uint ids[]; };
layout(std430, binding = kBindCoverage) writeonly buffer Coverage { uint coverage[]; };
layout(binding = kUnitFront) uniform usamplerBuffer front_texels;  // GBufferTexel
uniform CameraView camera;  // the same view as that of the discs

GBufferTexel texel_at(ivec2 pixel) {
    uvec4 words = texelFetch(front_texels, pixel.y * int(view_width) + pixel.x);
    return GBufferTexel(uintBitsToFloat(words.x), words.y, words.z, words.w);
}
bool in_picture(ivec2 pixel) {
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x < int(view_width) && pixel.y < int(view_height);
}

// Returns whether two neighbouring texels show two surfaces, or one of them none.
bool differ(GBufferTexel a, ivec2 pixel_a, GBufferTexel b, ivec2 pixel_b) {
    if (a.depth == 0.0 || b.depth == 0.0) return a.depth != b.depth;
    vec3 across = view_offset(camera, vec2(pixel_b) + 0.5, b.depth) - view_offset(camera, vec2(pixel_a) + 0.5, a.depth);
    return !is_one_surface(a, stored_normal(a), b, across, pixel_height(camera, max(a.depth, b.depth)));
}

// The samples of a pixel: the order of the nearest disc, and which of the nine pixels shows its surface.
uint nearest[kCoverageSamples];
uint shown[kCoverageSamples];

// Adds the disc that won a pixel to the samples of `here`.
void add_disc(uint id, ivec2 here, uint shows) {
    uint item;
    PackedSurfel surfel;
    ViewDisc disc;
    if (id == kNoSurfel || !cut_surfel(id, item, surfel) || !view_disc(item, surfel, disc)) return;
    // A disc competes for the pixel of its centre, wherever the rays of a frame pass through their pixels.
    vec2 place = vec2(-2.0);
    if (disc.centre.z > view_forward.w)
        place = disc.centre.xy / view_scale(disc.centre.z) * pixels_per_tangent() + view_middle() - 0.5 - vec2(here);
    for (uint i = 0u; i < kCoverageSamples; ++i) {
        vec2 at = coverage_sample(i), tangent = pixel_tangent(vec2(here) + at), apart = abs(place - at);
        bool at_home = max(apart.x, apart.y) < 0.5;
        uint key = disc_key(disc, disc_start(tangent), disc_ray(tangent), view_forward.w, at_home);
        if (key >= nearest[i]) continue;
        nearest[i] = key;
        shown[i] = shows;
    }
}

void main() {
    uint at = thread_number();
    if (at >= view_width * view_height) return;
    ivec2 here = ivec2(int(at % view_width), int(at / view_width));
    GBufferTexel own = texel_at(here);
    uint others = 0u;  // bits of the neighbours that show another surface
    // The deepest of these that lies behind the pixel's own surface shows where no disc is.
    uint behind = kCoverageNeighbours;
    float deepest = own.depth;
    for (uint i = 0u; i < kCoverageNeighbours; ++i) {
        ivec2 there = here + coverage_neighbour(i);
        if (!in_picture(there)) continue;
        GBufferTexel other = texel_at(there);
        if (!differ(own, here, other, there)) continue;
        others |= 1u << i;
        if (deepest != 0.0 && (other.depth == 0.0 || other.depth > deepest)) {
            deepest = other.depth;
            behind = i;
        }
    }
    coverage[at] = 0u;
    if (others == 0u) return;
    for (uint i = 0u; i < kCoverageSamples; ++i) {
        nearest[i] = kNoKey;
        shown[i] = behind;
    }
    add_disc(ids[at], here, kCoverageNeighbours);
    for (uint i = 0u; i < kCoverageNeighbours; ++i) {
        ivec2 there = here + coverage_neighbour(i);
        if (!in_picture(there)) continue;
        add_disc(ids[uint(there.y) * view_width + uint(there.x)], here,
                 (others >> i & 1u) != 0u ? i : kCoverageNeighbours);
    }
    uint word = 0u;
    for (uint i = 0u; i < kCoverageSamples; ++i)
        if (shown[i] < kCoverageNeighbours) word += 1u << (4u * shown[i]);
    coverage[at] = word;
}
