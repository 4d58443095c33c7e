// Places VPLs on emissive surfels, drawn in proportion to their share of the surface times the luminance of their
// emission. Surfels emit on both sides; a VPL has one side, drawn at random.
layout(local_size_x = 64) in;

#include "gi/engines/vpl/bindings.h"
#include "gi/shared/brdf.h"
#include "gi/shared/cut.glsl"
#include "gi/shared/luminance.h"
#include "gi/engines/vpl/vpl_light.h"

layout(std430, binding = kBindMaterials) readonly buffer Materials { Material materials[]; };
layout(std430, binding = kBindEmitters) readonly buffer Chosen { uint chosen[]; };  // surfel's id << 1 | side
layout(std430, binding = kBindLights) writeonly buffer Lights { VplLight lights[]; };

uniform uint first_light, light_count;
uniform float weight_sum;  // of all surfels, W/sr

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= light_count) return;
    uint item;
    PackedSurfel surfel;
    cut_surfel(chosen[index] >> 1, item, surfel);
    vec3 emission = materials[surfel_material(surfel.b)].emission.xyz;
    vec3 normal = surfel_has_normal(surfel) ? surfel_normal(surfel) : vec3(0.0, 0.0, 1.0);
    if ((chosen[index] & 1u) != 0u) normal = -normal;
    // The footprint is 1 / (VPLs * density), with both sides of the surface counted; intensity = radiance *
    // footprint.
    float footprint = 2.0 * weight_sum / (float(light_count) * luminance(emission));
    vec3 intensity = emission * footprint;
    lights[first_light + index] =
        VplLight(vec4(surfel_position(item, surfel), footprint), vec4(normal, cut_surfel_radius(item, surfel)),
                 vec4(intensity, 1.0), vec4(kPi * intensity, 1.0), vec4(normal, 0.0));
}
