// Computes the emission weight of every surfel of the light cut: its share of the surface times the luminance of its
// emission, W/sr.
#include "gi/engines/vpl/bindings.h"
#include "gi/shared/brdf.h"
#include "gi/shared/cut.glsl"
#include "gi/shared/luminance.h"

layout(local_size_x = kBlockSurfels) in;

layout(std430, binding = kBindMaterials) readonly buffer Materials { Material materials[]; };
layout(std430, binding = kBindEmitters) writeonly buffer Weights { float weights[]; };

void main() {
    uint id = gl_GlobalInvocationID.x;
    uint item;
    PackedSurfel surfel;
    float weight = 0.0;
    if (cut_surfel(id, item, surfel)) {
        vec3 emission = materials[surfel_material(surfel.b)].emission.xyz;
        weight = luminance(emission) * cut_surfel_area(item, surfel);
    }
    weights[id] = weight;
}
