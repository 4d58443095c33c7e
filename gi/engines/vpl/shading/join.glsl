// The geometry-aware gather (Preiner 2010, section 4.4): from which pixels of the interleaved tiles the light
// of a pixel is gathered. join.comp decides it once a frame, from geometry alone; shading and merging of every bounce
// follow it.
#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/shading/merging.h"
#include "gi/engines/vpl/shading/pixel.glsl"

layout(std430, binding = kBindJoints) buffer Joints { uvec2 joints[]; };  // for each tile, which candidates are alike: 4 bits

// The window about a pixel holds one pixel of every tile. This pixel, candidate 0, and those of the same tile n pixels
// to the other side of the receiver, candidates 1 to 3, are the corners of a square about the receiver.
ivec2 window_pixel(ivec2 pixel, int n, int i, int candidate) {
    ivec2 nearest = pixel + ivec2(i % n, i / n) - (n - 1) / 2;
    ivec2 outward = n * ivec2(nearest.x < pixel.x ? 1 : -1, nearest.y < pixel.y ? 1 : -1);
    return nearest + outward * ivec2(candidate & 1, candidate >> 1);
}
// Returns the candidate's weight in the bilinear interpolation over that square, so that the light of a tile changes
// smoothly from pixel to pixel. It is never 0: where the other candidates show other surfaces, one counts alone.
float candidate_weight(int n, int i, int candidate) {
    vec2 distance = abs(vec2(i % n, i / n) - float((n - 1) / 2));
    vec2 weight = mix(float(n) - distance, distance, vec2(candidate & 1, candidate >> 1));
    return max(weight.x * weight.y, kLeastCandidateWeight);
}
uint candidates_of(uvec2 joint, int i) { return ((i < 8 ? joint.x : joint.y) >> 4 * (i & 7)) & 15u; }
// Returns the mask of the tiles of which no candidate is alike.
uint missing_tiles(int n, uvec2 joint) {
    uint missing = 0u;
    for (int i = 0; i < n * n; ++i)
        if (candidates_of(joint, i) == 0u) missing |= 1u << i;
    return missing;
}
uint window_tile(ivec2 pixel, int n, int i) {
    ivec2 tile = (window_pixel(pixel, n, i, 0) + 2 * n) % n;
    return uint(tile.y * n + tile.x);
}

// Each tile alone estimates the whole light, but a VPL close by counts n^2 times in its own tile. So a pixel that
// finds fewer than half of the tiles is isolated and is shaded with the VPLs of all tiles that it lacks. Returns the
// number of those tiles; 0 for other pixels.
int tiles_lacking(int n, uint missing) {
    int found = n * n - bitCount(missing);
    return 2 * found < n * n ? n * n - found : 0;
}
