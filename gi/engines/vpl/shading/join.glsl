// The geometry-aware gather (Preiner 2010, section 4.4): from which pixels of the interleaved tiles the light
// of a pixel is gathered. join.comp decides it once a frame, from geometry alone; shading and merging of every bounce
// follow it.
#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/shading/pixel.glsl"

layout(std430, binding = kBindJoints) buffer Joints { uvec2 joints[]; };  // candidates, 2 bits per tile | mask of missing tiles

// The window about a pixel holds one pixel of every tile. If the pixel of tile i shows another surface, its
// neighbours of the same tile n pixels away, candidates 1 to 3, may replace it.
ivec2 window_pixel(ivec2 pixel, int n, int i, int candidate) {
    ivec2 nearest = pixel + ivec2(i % n, i / n) - (n - 1) / 2;
    ivec2 outward = n * ivec2(nearest.x < pixel.x ? 1 : -1, nearest.y < pixel.y ? 1 : -1);
    return nearest + outward * ivec2(candidate & 1, candidate >> 1);
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
