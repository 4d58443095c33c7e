// Shades isolated pixels, which have too few neighbours of their own surface, with the VPLs of the panes that they
// lack.
#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/shading/isolated.h"
#include "gi/engines/vpl/shading/join.glsl"

layout(std430, binding = kBindLonely) readonly buffer Lonely {
    IsolatedHeader lonely;
    uint lonely_pixels[];
};
layout(std430, binding = kBindDiffuse) buffer OwnDiffuse { vec4 own_diffuse[]; };
layout(std430, binding = kBindSpecular) buffer OwnSpecular { vec4 own_specular[]; };

layout(local_size_x = kIsolatedGroup) in;

void shade(uint index) {
    uvec2 pixel = uvec2(index % camera.width, index / camera.width);
    Receiver receiver = pixel_receiver(pixel, camera_texel(index));
    int n = int(interleave);
    uint missing = joints[index].y;
    int lacking = panes_lacking(n, missing);
    Gathered sum = Gathered(vec3(0.0), vec3(0.0));
    do {
        Gathered pane = gather_pane(receiver, window_pane(ivec2(pixel), n, findLSB(missing)));
        sum.irradiance += pane.irradiance;
        sum.specular += pane.specular;
        missing &= missing - 1u;
        --lacking;
    } while (lacking > 0);
    own_diffuse[index] += vec4(sum.irradiance, 0.0);
#ifdef LUCARNE_GLOSSY
    own_specular[index] += vec4(sum.specular, 0.0);
#endif
}

void main() {
    uint number = gl_GlobalInvocationID.x;
    if (number >= lonely.count) return;
    do {
        shade(lonely_pixels[number]);
        number += gl_NumWorkGroups.x * kIsolatedGroup;
    } while (number < lonely.count);
}
