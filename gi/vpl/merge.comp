// The indirect light of every pixel: panes filtered, times the receiver's reflectance, plus its specular light.
layout(local_size_x = 8, local_size_y = 8) in;

#include "gi/vpl/filter.glsl"

layout(std430, binding = 14) writeonly buffer Radiance { vec4 radiance[]; };

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (pixel.x >= camera.width || pixel.y >= camera.height) return;
    uint index = pixel.y * camera.width + pixel.x;
    GBufferTexel texel = camera_texel(index);
    vec3 light = vec3(0.0);
    if (texel.depth > 0.0) {
        Receiver receiver = pixel_receiver(pixel, texel);
        Gathered gathered = filter_panes(pixel, receiver, texel.depth);
        light = gathered.irradiance * receiver.reflectance.kd / kPi + gathered.specular;
    }
    radiance[index] = vec4(light, 1.0);
}
