// The picture: filtered indirect light times the receiver's reflectance, direct light, emission and background.
layout(local_size_x = 8, local_size_y = 8) in;

#include "gi/vpl/pixel.glsl"
#ifdef LUCARNE_INDIRECT
#include "gi/vpl/filter.glsl"
#endif

layout(std430, binding = 14) writeonly buffer Radiance { vec4 radiance[]; };

uniform uint add_direct;

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    CameraView view = constants.camera;
    if (pixel.x >= view.width || pixel.y >= view.height) return;
    uint index = pixel.y * view.width + pixel.x;
    GBufferTexel texel = texels[index];
    vec3 light = add_direct != 0u ? constants.background.xyz : vec3(0.0);
    if (texel.depth > 0.0) {
        Receiver receiver = pixel_receiver(pixel, texel);
        light = vec3(0.0);
#ifdef LUCARNE_INDIRECT
        Gathered gathered = filter_panes(pixel, receiver, texel.depth);
        light += gathered.irradiance * receiver.reflectance.kd / kPi + gathered.specular;
#endif
    }
    radiance[index] = vec4(light, 1.0);
}
