// Adds the reflected light of one light to the picture, as far as one view of the light shows it.
layout(local_size_x = 8, local_size_y = 8) in;
#include "gi/lighting/bindings.h"
#include "gi/lighting/shadow.glsl"
#include "gi/shared/brdf.h"
#include "gi/shared/light.h"

layout(std430, binding = kBindCameraTexels) readonly buffer CameraTexels { GBufferTexel texels[]; };
layout(std430, binding = kBindLightingMaterials) readonly buffer Materials { Material materials[]; };
layout(std430, binding = kBindLitRadiance) buffer Radiance { vec4 radiance[]; };
uniform CameraView camera;
uniform Light light;
uniform uint face;  // the face of the light that light_view shows

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (pixel.x >= camera.width || pixel.y >= camera.height) return;
    uint at = pixel.y * camera.width + pixel.x;
    GBufferTexel texel = texels[at];
    if (!(texel.depth > 0.0)) return;
    vec3 position = texel_position(camera, pixel, texel);
    vec3 normal = texel_normal(texel);
    vec3 to_light;
    vec3 irradiance = light_irradiance(light, position, normal, to_light);
    if (irradiance == vec3(0.0)) return;
    if (light_face(light, position - light.position.xyz) != face) return;
    float visible = spot_visibility(position, normal, texel_radius(texel));
    Reflectance reflectance = make_reflectance(materials[texel_material(texel)], texel_albedo(texel));
    vec3 to_eye = toward_viewer(camera, position);
    radiance[at].rgb += visible * irradiance * brdf(reflectance, normal, to_light, to_eye);
}
