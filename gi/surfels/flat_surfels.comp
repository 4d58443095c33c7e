// Decodes the surfels of a cut with their footprints, in the order of their ids. Ids in gaps get radius and area 0.
#include "gi/surfels/bindings.h"
#include "gi/shared/cut.glsl"
#include "gi/shared/flat_surfel.h"
#include "gi/shared/many_threads.glsl"

layout(local_size_x = kBlockSurfels) in;

layout(std430, binding = kBindFlatSurfels) writeonly buffer Flat { FlatSurfel flat_surfels[]; };
uniform uint ids;

void main() {
    uint id = thread_number();
    if (id >= ids) return;
    uint item;
    PackedSurfel surfel;
    FlatSurfel decoded = FlatSurfel(0.0, 0.0, 0.0, 0.0, 0.0, 0u, 0u, 0u, 0.0);
    if (cut_surfel(id, item, surfel)) {
        vec3 position = surfel_position(item, surfel);
        bool ends = (surfel.d & kSurfelHasEdge) != 0u;
        decoded = FlatSurfel(position.x, position.y, position.z, cut_surfel_round_radius(item, surfel),
                             cut_surfel_area(item, surfel), surfel.c, surfel.d & ~kSurfelHasEdge,
                             surfel_material(surfel.b),
                             ends ? sqrt(surfel_own_area(surfel.b, cut_item_cube(item).w)) : 0.0);
    }
    flat_surfels[id] = decoded;
}
