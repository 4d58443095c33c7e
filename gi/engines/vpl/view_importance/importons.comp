// Places importons on what the camera sees: points that emit importance as VPLs emit light, one for each cell of a grid
// over the picture. What they send to a place is what light from there adds to the picture (Segovia, Iehl, Mitanchey &
// Peroche 2006, "Bidirectional instant radiosity"; importons: Christensen 2003).
layout(local_size_x = 64) in;

#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/vpl_light.h"
#include "gi/shared/brdf.h"
#include "gi/shared/gbuffer.h"

layout(std430, binding = kBindMaterials) readonly buffer Materials { Material materials[]; };
layout(std430, binding = kBindGBuffer) readonly buffer GBufferTexels { GBufferTexel texels[]; };
layout(std430, binding = kBindLights) writeonly buffer Lights { VplLight lights[]; };

uniform CameraView camera;
uniform uint cells;  // along a side of the grid
uniform vec2 shift;  // in [0, 1)^2, another one each frame

// Pixels of a cell that are tried until one shows a surface.
const uint kPixelTries = 4u;

VplLight importon_at(uvec2 pixel, GBufferTexel texel) {
    vec3 position = texel_position(camera, pixel, texel);
    vec3 normal = texel_normal(texel);
    vec3 viewer = toward_viewer(camera, position);
    Reflectance r = make_reflectance(materials[texel_material(texel)], texel_albedo(texel));
    float height = pixel_height(camera, texel.depth);
    float pixels = float(camera.width) * float(camera.height) / float(cells * cells);
    float footprint = height * height * pixels / max(dot(normal, viewer), 0.1);
    // All cells count alike: an importance of pi, shared out.
    vec3 flux = vec3(kPi / float(cells * cells));
    return VplLight(vec4(position, footprint), vec4(normal, texel_radius(texel)), vec4(flux * r.kd / kPi, r.exponent),
                    vec4(flux, 1.0), vec4(viewer, r.ks));
}

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= cells * cells) return;
    vec2 cell = vec2(index % cells, index / cells);
    VplLight importon = VplLight(vec4(vec3(1e18), 0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
    for (uint i = 0u; i < kPixelTries; ++i) {
        // The R2 sequence (Roberts 2018): even over the cells and over the tries.
        vec2 within = fract(shift + vec2(0.7548776662, 0.5698402910) * float(index * kPixelTries + i));
        uvec2 size = uvec2(camera.width, camera.height);
        uvec2 pixel = min(uvec2((cell + within) / float(cells) * vec2(size)), size - 1u);
        GBufferTexel texel = texels[pixel.y * size.x + pixel.x];
        if (texel.depth <= 0.0) continue;
        importon = importon_at(pixel, texel);
        break;
    }
    lights[index] = importon;
}
