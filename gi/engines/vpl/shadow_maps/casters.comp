// Decodes the surfels of the light cut to casters for the passes that draw them into the shadow maps.
#include "gi/engines/vpl/bindings.h"
#include "gi/shared/cut.glsl"
#include "gi/engines/vpl/shadow_maps/casters.glsl"

layout(local_size_x = kBlockSurfels) in;

layout(std430, binding = kBindCasters) writeonly buffer Casters { uvec4 codes[]; };

void main() {
    uint id = gl_GlobalInvocationID.x;
    uint item;
    PackedSurfel surfel;
    Caster caster = Caster(vec3(0.0), vec3(0.0), 0.0, 0.0);
    if (cut_surfel(id, item, surfel)) {
        caster.position = surfel_position(item, surfel);
        if (surfel_has_normal(surfel)) caster.normal = surfel_normal(surfel);
        caster.radius = cut_surfel_round_radius(item, surfel);
        caster.lod_area = max(surfel_lod_area(id), cut_surfel_area(item, surfel));
    }
    codes[id] = encode_caster(caster);
}
