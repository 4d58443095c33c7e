// Adds to every surfel the irradiance of its two sides by one light, as far as one view of the light shows it.
layout(local_size_x = 256) in;
#include "gi/lighting/bindings.h"
#include "gi/lighting/shadow.glsl"
#include "gi/shared/flat_surfel.h"
#include "gi/shared/light.h"
#include "gi/shared/many_threads.glsl"

layout(std430, binding = kBindLitSurfels) readonly buffer Surfels { FlatSurfel surfels[]; };
layout(std430, binding = kBindSurfelIrradiance) buffer Irradiance { float irradiance[]; };  // six a surfel
layout(std430, binding = kBindSurfelDirections) buffer Directions { float directions[]; };  // likewise
uniform uint count;
uniform Light light;
uniform uint face;  // the face of the light that light_view shows
uniform uint directed;  // 1 if directions are wanted

void main() {
    uint id = thread_number();
    if (id >= count) return;
    FlatSurfel surfel = surfels[id];
    if (!(surfel.radius > 0.0) || (surfel.albedo & kSurfelHasNormal) == 0u) return;
    vec3 position = vec3(surfel.x, surfel.y, surfel.z);
    vec3 normal = decode_octahedral(surfel.normal);
    if (light_face(light, position - light.position.xyz) != face) return;
    // A sharp light reaches one of the two sides.
    vec3 to_light;
    uint side = 0u;
    vec3 arriving = light_irradiance(light, position, normal, to_light);
    if (arriving == vec3(0.0)) {
        side = 1u;
        normal = -normal;
        arriving = light_irradiance(light, position, normal, to_light);
    }
    if (arriving == vec3(0.0)) return;
    arriving *= spot_visibility(position, normal, surfel.radius);
    uint at = 6u * id + 3u * side;
    irradiance[at] += arriving.r;
    irradiance[at + 1u] += arriving.g;
    irradiance[at + 2u] += arriving.b;
    if (directed == 0u) return;
    vec3 toward = to_light * ((arriving.r + arriving.g + arriving.b) / 3.0);
    directions[at] += toward.x;
    directions[at + 1u] += toward.y;
    directions[at + 2u] += toward.z;
}
