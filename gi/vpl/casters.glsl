// The light cut's surfels as the shadow maps' splatting reads them, once decoded: 16 bytes each, by their id.
#include "gi/shared/surfel_code.h"
#include "gi/vpl/vpl_light.h"

layout(std430, binding = 9) readonly buffer Lights { VplLight lights[]; };
layout(std430, binding = 5) buffer Casters { uvec4 caster_codes[]; };

struct Caster {
    vec3 position;
    vec3 normal;   // unit; zero: the surfel has none
    float radius;  // of its disc; 0: there is no surfel of this id
};

// w: normal as two 12-bit octahedral coordinates (.05 degrees; 0: none) | radius << 24, 2^((code - 128) / 8) m.
uvec4 encode_caster(Caster caster) {
    uint radius = caster.radius > 0.0 ? uint(clamp(8.0 * log2(caster.radius) + 128.5, 1.0, 255.0)) : 0u;
    uint normal = 0u;
    if (caster.normal != vec3(0.0)) {
        vec2 p = unpackSnorm2x16(encode_octahedral(caster.normal));
        uvec2 steps = uvec2(clamp(p * 2047.0 + 2048.5, 1.0, 4095.0));
        normal = steps.x | steps.y << 12;
    }
    return uvec4(floatBitsToUint(caster.position), normal | radius << 24);
}

float caster_radius(uvec4 code) {
    uint radius = code.w >> 24;
    return radius == 0u ? 0.0 : exp2(0.125 * (float(radius) - 128.0));
}

Caster decode_caster(uvec4 code) {
    Caster caster = Caster(uintBitsToFloat(code.xyz), vec3(0.0), caster_radius(code));
    if ((code.w & 0xffffffu) != 0u) {
        vec2 p = (vec2(code.w & 4095u, code.w >> 12 & 4095u) - 2048.0) / 2047.0;
        caster.normal = decode_octahedral(packSnorm2x16(p));
    }
    return caster;
}
