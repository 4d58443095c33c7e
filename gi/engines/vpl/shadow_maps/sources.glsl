// Which surfel a texel of the atlas shows: distance | id, so that the least is the nearest one's, as in the atlas. The
// distance has what bits the ids leave: 2 % of it a step at 4M surfels.
layout(std430, binding = 8) buffer Sources { uint sources[]; };

uniform uint id_bits;

uint pack_source(float distance_m, uint id) {
    float octaves = log2(distance_m / cut_size) + 14.0;  // of 16, up to four sides of the cut
    uint most = (1u << (32u - id_bits)) - 1u;
    return uint(clamp(octaves / 16.0, 0.0, 1.0) * float(most)) << id_bits | id;
}
