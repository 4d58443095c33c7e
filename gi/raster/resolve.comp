// Writes the texel of the surfel that took each pixel; one invocation a pixel.
layout(local_size_x = 64) in;
#include "gi/raster/bindings.h"
#include "gi/shared/many_threads.glsl"
#include "gi/raster/disc.glsl"
#include "gi/raster/queues.h"

layout(std430, binding = kBindIds) readonly buffer Ids { uint ids[]; };
layout(std430, binding = kBindTexels) writeonly buffer Texels { GBufferTexel texels[]; };
layout(std430, binding = kBindBlocks) buffer Blocks { uint seen_blocks[]; };
layout(std430, binding = kBindQueues) buffer Queues { QueueHeader queues; };
uniform uint blocks;  // of the cut

// Lists a block once: a flag for every block of the cut, then the list.
void list_block(uint block) {
    if (seen_blocks[block] == 0u && atomicExchange(seen_blocks[block], 1u) == 0u)
        seen_blocks[blocks + atomicAdd(queues.seen_count, 1u)] = block;
}

void main() {
    uint at = thread_number();
    if (at >= view_width * view_height) return;
    uint id = ids[at];
    uint item;
    PackedSurfel surfel;
    ViewDisc disc;
    GBufferTexel texel = GBufferTexel(0.0, 0u, 0u, 0u);
    if (id != kNoSurfel && cut_surfel(id, item, surfel) && view_disc(item, surfel, disc)) {
        vec2 tangent = pixel_tangent(vec2(at % view_width, at / view_width));
        vec3 ray = disc_ray(tangent);
        // Points of a fixed size are drawn facing the eye, but are lit by their own normal.
        vec3 normal = surfel_has_normal(surfel) ? to_view(surfel_normal(surfel)) : disc.normal;
        bool behind = dot(normal, ray) > 0.0;
        if (behind) normal = -normal;
        vec3 world = normal.x * view_right.xyz + normal.y * view_down.xyz + normal.z * view_forward.xyz;
        texel.depth = disc_depth(disc, disc_start(tangent), ray);
        texel.normal = encode_octahedral(world);
        texel.albedo = (surfel.d & ~kSurfelHasEdge) | (behind && surfel_has_normal(surfel) ? kTexelFromBehind : 0u);
        texel.material = surfel_material(surfel.b) | packHalf2x16(vec2(0.0, disc.radius));
        list_block(id / kBlockSurfels);
    }
    texels[at] = texel;
}
