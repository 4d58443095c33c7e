// The sphere about each cluster of VPLs: the middle of their box, and the farthest of them.
layout(local_size_x = 64) in;

#include "gi/vpl/clusters.glsl"

void main() {
    uint cluster = gl_GlobalInvocationID.x;
    uint first = cluster * kClusterLights, last = min(first + kClusterLights, maps);
    if (first >= maps) return;
    vec3 low = vec3(1e30), high = vec3(-1e30);
    for (uint i = first; i < last; ++i) {
        if (!is_alive(lights[i])) continue;
        low = min(low, lights[i].position.xyz);
        high = max(high, lights[i].position.xyz);
    }
    vec4 sphere = vec4(0.5 * (low + high), -1.0);
    for (uint i = first; i < last; ++i)
        if (is_alive(lights[i])) sphere.w = max(sphere.w, distance(lights[i].position.xyz, sphere.xyz));
    clusters[cluster] = sphere;
}
