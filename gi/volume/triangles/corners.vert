// Fetches the corners of triangles by their numbers.
#include "gi/shared/surfel_code.h"
#include "gi/volume/triangles/bindings.h"

layout(binding = kUnitCorners) uniform usamplerBuffer corners;

out vec3 place;   // in units of voxels
out vec3 albedo;  // linear Rec. 709

void main() {
    uvec4 corner = texelFetch(corners, gl_VertexID);
    place = uintBitsToFloat(corner.xyz);
    albedo = decode_albedo(corner.w);
    gl_Position = vec4(0.0);
}
