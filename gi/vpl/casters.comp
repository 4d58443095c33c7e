// Decodes the surfels of the light cut for the passes that draw them into the shadow maps.
layout(local_size_x = 256) in;

#include "gi/shared/cut.glsl"
#include "gi/vpl/casters.glsl"

// Disc area over surface. A random pattern leaves e^-C of the rays through: 2 % at 4, most of them holes of one texel
// that pull-push closes. Larger discs overhang the edges of objects further.
const float kCoverage = 4.0;

void main() {
    uint id = gl_GlobalInvocationID.x;
    uint item;
    PackedSurfel surfel;
    Caster caster = Caster(vec3(0.0), vec3(0.0), 0.0);
    if (cut_surfel(id, item, surfel)) {
        caster.position = surfel_position(item, surfel);
        if (surfel_has_normal(surfel)) caster.normal = surfel_normal(surfel);
        caster.radius = sqrt(kCoverage / 3.14159265 * cut_surfel_area(item, surfel));
    }
    caster_codes[id] = encode_caster(caster);
}
