// Casters: the surfels of the light cut, decoded once for splatting into the shadow maps; 16 bytes each, by id.
#include "gi/engines/vpl/bindings.h"
#include "gi/shared/surfel_code.h"

uniform float cut_size;  // side of the root of the cut, m; radii and areas are coded relative to it

struct Caster {
    vec3 position;
    vec3 normal;     // unit; zero: the surfel has none
    float radius;    // of its disc, m; 0: no surfel has this id
    float lod_area;  // m^2, the area it stands for if no finer surfels are drawn; at least its area in the cut
};

// xyz: position. w: normal as two 9-bit octahedral coordinates (.3 degrees; 0: none) | radius, 7 bits in steps of
// 2^(1/6) | lod_area, 7 bits in steps of 2^(1/4).
uvec4 encode_caster(Caster caster) {
    uint radius = 0u, normal = 0u;
    if (caster.radius > 0.0) radius = uint(clamp(6.0 * log2(caster.radius / cut_size) + 127.5, 1.0, 127.0));
    uint lod = uint(clamp(4.0 * log2(caster.lod_area / (cut_size * cut_size)) + 127.5, 0.0, 127.0));
    if (caster.normal != vec3(0.0)) {
        vec2 p = unpackSnorm2x16(encode_octahedral(caster.normal));
        uvec2 steps = uvec2(clamp(p * 255.0 + 256.5, 1.0, 511.0));
        normal = steps.x | steps.y << 9;
    }
    return uvec4(floatBitsToUint(caster.position), normal | radius << 18 | lod << 25);
}

Caster decode_caster(uvec4 code) {
    Caster caster = Caster(uintBitsToFloat(code.xyz), vec3(0.0), 0.0, 0.0);
    uint radius = code.w >> 18 & 127u;
    if (radius != 0u) caster.radius = exp2((float(radius) - 127.0) / 6.0) * cut_size;
    caster.lod_area = exp2((float(code.w >> 25) - 127.0) * 0.25) * cut_size * cut_size;
    if ((code.w & 0x3ffffu) != 0u) {
        vec2 p = (vec2(code.w & 511u, code.w >> 9 & 511u) - 256.0) / 255.0;
        caster.normal = decode_octahedral(packSnorm2x16(p));
    }
    return caster;
}

layout(binding = kUnitCasters) uniform usamplerBuffer caster_codes;

Caster read_caster(uint id) { return decode_caster(texelFetch(caster_codes, int(id))); }
