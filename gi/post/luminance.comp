// Sums over one run of pixels an invocation, in order, so that the result is the same every time.
layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Radiance { vec4 radiance[]; };
layout(std430, binding = 1) writeonly buffer Sums { vec2 sums[]; };
uniform uint pixels;
uniform uint run;      // pixels an invocation
uniform float floor_luminance;  // 0: sum luminances; else logarithms of luminances no smaller than this

void main() {
    uint part = gl_GlobalInvocationID.x;
    vec2 sum = vec2(0.0);  // and how many
    if (part * run >= pixels) return;
    uint last = min((part + 1u) * run, pixels);
    for (uint at = part * run; at < last; ++at) {
        float luminance = dot(radiance[at].rgb, vec3(0.2126, 0.7152, 0.0722));
        if (!(luminance > 0.0) || isinf(luminance)) continue;
        sum += vec2(floor_luminance > 0.0 ? log2(max(luminance, floor_luminance)) : luminance, 1.0);
    }
    sums[part] = sum;
}
