// Splats large discs: a workgroup each, whose invocations share the texels.
#include "gi/engines/vpl/shadow_maps/disc.glsl"

layout(local_size_x = kLargeGroup) in;

void draw(uvec2 pair) {
    MapDisc disc;
    ivec2 first, last;
    if (!disc_over(pair.y, read_caster(pair.x), disc)) return;
    map_box(disc, first, last);
    int width = last.x - first.x + 1;
    int texels = width * (last.y - first.y + 1);
    uint surface = disc_surface(disc);
    for (int i = int(gl_LocalInvocationID.x); i < texels; i += int(kLargeGroup)) {
        int row = int((float(i) + 0.5) / float(width));  // exact below 2^23, and faster than integers
        uvec2 at = uvec2(first + ivec2(i - row * width, row));
        vec2 uv = texel_centre(at);
        Hit hit = map_hit(disc, uv);
        float distance_m = hit.t * (1.0 + dot(uv, uv));
        uint index = texel_index(pair.y, at);
        if (hit.t > 0.0 && hit.core) take_core(pair, index, distance_m, surface);
        if (hit.t > 0.0 && !hit.core) take_fringe(pair, index, distance_m, surface);
    }
}

void main() {
    uint count = queues[queue].large_count;
    for (uint i = gl_WorkGroupID.x; i < count; i += gl_NumWorkGroups.x) draw(pairs[large_places[i]]);
}
