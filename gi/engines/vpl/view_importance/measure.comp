// Adds up what importons send to each candidate: how much the light of a VPL there adds to the picture. With the shadow
// maps of the importons, this is the shading of a receiver by VPLs.
layout(local_size_x = 64) in;

#include "gi/engines/vpl/bindings.h"
#include "gi/shared/brdf.h"
#include "gi/shared/luminance.h"
#include "gi/engines/vpl/shading/gather.glsl"

layout(std430, binding = kBindLights) readonly buffer Candidates { VplLight candidates[]; };
layout(std430, binding = kBindViewImportance) buffer ViewImportance { float view_importance[]; };

uniform uint candidate_count, importon_count;

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= candidate_count) return;
    VplLight candidate = candidates[index];
    if (dot(candidate.normal.xyz, candidate.normal.xyz) == 0.0) return;  // dead
    Receiver receiver;
    receiver.position = candidate.position.xyz;
    receiver.normal = candidate.normal.xyz;
    receiver.radius = candidate.normal.w;
    receiver.to_viewer = candidate.normal.xyz;
    Gathered gathered = gather(receiver, 0u, 1u, importon_count);
    view_importance[index] += luminance(gathered.irradiance);
}
