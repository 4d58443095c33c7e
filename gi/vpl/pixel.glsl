// A pixel of the camera's G-buffer as shading and merging see it, and the buffers between the two.
#include "gi/shared/gbuffer.glsl"
#include "gi/vpl/gather.glsl"

layout(std430, binding = 3) readonly buffer Materials { Material materials[]; };
layout(std430, binding = 4) readonly buffer CameraGBuffer { GBufferTexel texels[]; };
layout(std430, binding = 12) buffer DiffuseLight { vec4 diffuse_light[]; };    // irradiance, W/m^2
layout(std430, binding = 13) buffer SpecularLight { vec4 specular_light[]; };  // radiance, W/(sr m^2)

uniform CameraView camera;
uniform uint interleave;   // n
uniform uint light_count;  // M

Receiver pixel_receiver(uvec2 pixel, GBufferTexel texel) {
    Receiver receiver;
    receiver.position = texel_position(camera, pixel, texel);
    receiver.normal = texel_normal(texel);
    receiver.radius = texel_radius(texel);
    receiver.to_viewer = normalize(camera.origin.xyz - receiver.position);
    receiver.reflectance = make_reflectance(materials[texel_material(texel)], texel_albedo(texel));
    return receiver;
}

// One pane's estimate of the light from all VPLs.
Gathered gather_pane(Receiver receiver, uint pane) {
    uint panes = interleave * interleave;
    Gathered gathered = gather(receiver, pane, panes, light_count);
    gathered.irradiance *= float(panes);
    gathered.specular *= float(panes);
    return gathered;
}
