// The surfel that a texel of the atlas shows: distance | id, so that the smallest code is the nearest surfel, as in
// the atlas. The distance has the bits that the ids leave: steps of 2 % at 4M surfels.
#include "gi/engines/vpl/bindings.h"

layout(std430, binding = kBindSources) buffer Sources { uint sources[]; };

uniform uint id_bits;

uint pack_source(float distance_m, uint id) {
    float octaves = log2(distance_m / cut_size) + 14.0;  // 0 to 16; 16 is four sides of the cut
    uint most = (1u << (32u - id_bits)) - 1u;
    return uint(clamp(octaves / 16.0, 0.0, 1.0) * float(most)) << id_bits | id;
}
