// Chooses the maps that each surfel enters (thinning.glsl) and queues (surfel, map) pairs for splat.comp: one
// invocation a surfel, kRunMaps maps a dispatch. Splatting at once would leave most lanes idle, for one pair in a
// hundred is chosen. The maps are written out one after the other, without branches and with their VPLs in uniforms,
// for llvmpipe: there it is seven times as fast as a loop over storage buffers.
layout(local_size_x = 256) in;

#include "gi/vpl/casters.glsl"
#include "gi/vpl/queue.glsl"
#include "gi/vpl/thinning.glsl"

uniform uint first_id, id_end, first_map, seed;
uniform vec4 run_position[32], run_normal[32];  // of the VPLs first_map ...

// Multiples of these, modulo 1 (of 2^32), are as even as multiples of a number can be, at every scale: their continued
// fractions are all ones and all twos.
const uint kIdStep = 2654435769u;   // golden ratio - 1
const uint kMapStep = 1779033704u;  // square root of 2, - 1

uint entered = 0u;  // bit k: the surfel enters map first_map + k

void main() {
    uint id = first_id + gl_GlobalInvocationID.x;
    Caster caster = decode_caster(caster_codes[id]);
    if (id >= id_end) caster.radius = 0.0;
    // A surfel without a normal faces every VPL: |n.offset| is its distance.
    float no_normal = caster.normal == vec3(0.0) ? 1.0 : 0.0;
    float scale = kThinnedCover * caster.radius * caster.radius / (splat_angle * splat_angle);
    uint random = seed + id * kIdStep + first_map * kMapStep;

// u < kThinnedCover q, multiplied by the cube of the distance. The numbers u are even over the maps of a surfel, and over the
// surfels of a map in the order of their ids, which is even itself (a node's prefix order): fewer holes than by chance. What lies wholly behind the VPL's tangent
// plane is of no use.
#define LUCARNE_TRY_MAP(k)                                                                            \
    {                                                                                                 \
        vec3 offset = caster.position - run_position[k].xyz;                         \
        float distance2 = dot(offset, offset);                                                        \
        float distance_m = sqrt(distance2);                                                           \
        float along = max(abs(dot(caster.normal, offset)), max(no_normal, kLeastSlant) * distance_m); \
        float height = dot(run_normal[k].xyz, offset);                               \
        float u = float((random + (k) * kMapStep) >> 8) / 16777216.0;                              \
        bool over = height > -caster.radius - kLargestSplat * splat_angle * distance_m;               \
        entered |= over && u * distance2 * distance_m < scale * along ? 1u << (k) : 0u;               \
    }
#define LUCARNE_TRY_4(k) LUCARNE_TRY_MAP(k) LUCARNE_TRY_MAP(k + 1u) LUCARNE_TRY_MAP(k + 2u) LUCARNE_TRY_MAP(k + 3u)
#define LUCARNE_TRY_16(k) LUCARNE_TRY_4(k) LUCARNE_TRY_4(k + 4u) LUCARNE_TRY_4(k + 8u) LUCARNE_TRY_4(k + 12u)
    LUCARNE_TRY_16(0u)
    LUCARNE_TRY_16(16u)
    for (; entered != 0u; entered &= entered - 1u) queue_pair(id, first_map + uint(findLSB(entered)));
}
