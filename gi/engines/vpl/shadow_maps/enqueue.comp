// Enqueues the pairs of surfel and map that have to be drawn: a workgroup a block, an invocation a surfel. Each
// surfel is tested against the maps for which cull.comp did not cull its block. Splatting without a queue would leave
// most lanes idle.
#include "gi/engines/vpl/shadow_maps/casters.glsl"
#include "gi/engines/vpl/lights.glsl"
#include "gi/engines/vpl/shadow_maps/queue.glsl"
#include "gi/engines/vpl/shadow_maps/thinning.glsl"
#include "gi/shared/surfel.h"

layout(local_size_x = kBlockSurfels) in;

uniform uint first_block, first_map;
uniform uint places;  // length of pairs[]

void queue_pairs(uint id, uint first, uint entered) {
    if (entered == 0u) return;
    uint place = atomicAdd(queues[queue].pair_count, uint(bitCount(entered)));
    do {
        if (place < places) pairs[place] = uvec2(id, first + uint(findLSB(entered)));
        ++place;
        entered &= entered - 1u;
    } while (entered != 0u);
}

// Returns the next word that is not empty. Most are empty, and llvmpipe does not skip a loop body that no lane
// enters, so this loop is separate.
uint next_word(uint block, uint word) {
    while (word < kRunWords && meetings[block * kRunWords + word] == 0u) ++word;
    return word;
}

void main() {
    uint block = first_block + gl_WorkGroupID.x;
    uint id = block * kBlockSurfels + gl_LocalInvocationID.x;
    Caster caster = read_caster(id);
    // A surfel without a normal faces every VPL. An id without a surfel fails every test, because its scale is
    // negative.
    float least_slant = caster.normal == vec3(0.0) ? 1.0 : kLeastSlant;
    float largest_splat = kLargestSplat * splat_angle;
    // The test is needed_area() <= lod_area, multiplied by the cube of the distance.
    float scale = caster.radius > 0.0 ? caster.lod_area / needed_area(1.0, 1.0) : -1.0;
    uint word = next_word(block, 0u);
    while (word < kRunWords) {
        uint met = meetings[block * kRunWords + word];
        uint first = first_map + word * 32u;
        uint entered = 0u;
        for (; met != 0u; met &= met - 1u) {
            uint bit = uint(findLSB(met));
            vec4 normal = vpl_normal(first + bit);
            vec3 offset = caster.position - (vpl_position(first + bit).xyz + normal.xyz * normal.w);
            float distance2 = dot(offset, offset);
            float distance_m = sqrt(distance2);
            float along = max(abs(dot(caster.normal, offset)), least_slant * distance_m);
            // Surfels wholly behind the tangent plane of the VPL are not needed.
            bool over = dot(normal.xyz, offset) > -caster.radius - largest_splat * distance_m;
            entered |= over && scale * along >= distance2 * distance_m ? 1u << bit : 0u;
        }
        queue_pairs(id, first, entered);
        word = next_word(block, word + 1u);
    }
}
