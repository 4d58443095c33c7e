// Tests whether a light view (gi/lighting/light_view.h) sees a point. The G-buffer of the view serves as the shadow
// map.
#include "gi/lighting/bindings.h"
#include "gi/shared/gbuffer.h"

layout(std430, binding = kBindLightTexels) readonly buffer LightTexels { GBufferTexel light_texels[]; };
uniform CameraView light_view;

GBufferTexel light_texel(inout ivec2 pixel) {
    pixel = clamp(pixel, ivec2(0), ivec2(light_view.width, light_view.height) - 1);
    return light_texels[uint(pixel.y) * light_view.width + uint(pixel.x)];
}

// Returns how far a point is lifted off its surface before the look-up, as the rays of the reference are
// (gi/engines/reference/README.md): by a radius, its own or that of a disc beside it in the map, so that neither
// noise nor the rims of discs that stick out at edges shade or hide it; and at least by the area that one look-up
// blurs together.
float shadow_lift(vec3 position, float radius) {
    float depth;
    ivec2 pixel = ivec2(view_place(light_view, position, depth));
    float footprint = depth * 2.0 * length(light_view.right.xyz) / float(light_view.width);
    float lift = max(radius, 1.5 * footprint);
    float caster_radius = texel_radius(light_texel(pixel));
    float caster_depth = light_texel(pixel).depth;
    if (caster_depth > 0.0 && abs(caster_depth - depth) < 4.0 * caster_radius) lift = max(lift, caster_radius);
    return lift * (1.0 + kRimPush);  // texel_blocks subtracts the margin again
}

// Returns whether the surface in this texel of the light view stands between the light and the lifted point.
// Comparing two depths, which differ over a texel, would cause acne, so the point is compared with the plane of the
// caster's disc. It has to stand in front of that plane by as much as the G-buffer lets a disc stick out of the
// surface that hides it; otherwise the rims of walls would catch light from outside the room.
bool texel_blocks(ivec2 pixel, vec3 lifted, float depth, float radius) {
    GBufferTexel texel = light_texel(pixel);
    if (!(texel.depth > 0.0)) return false;
    float caster_radius = texel_radius(texel);
    vec3 caster = texel_position(light_view, uvec2(pixel), texel);
    // The plane is infinite but the disc is not: a point nearer to the light than the disc reaches is not behind it.
    float margin = kRimPush * max(radius, caster_radius);
    return depth > texel.depth - 2.0 * caster_radius && dot(texel_normal(texel), lifted - caster) < margin;
}

// Returns the share of the light that arrives, 0 to 1: the four nearest texels, weighted bilinearly
// (percentage-closer filtering; Reeves, Salesin & Cook 1987). `normal` faces the light; `radius` is that of the
// surfel of the point.
float spot_visibility(vec3 position, vec3 normal, float radius) {
    float depth;
    view_place(light_view, position, depth);
    if (depth <= 0.0) return 0.0;
    vec3 lifted = position + normal * shadow_lift(position, radius);
    vec2 at = view_place(light_view, lifted, depth) - 0.5;
    if (depth <= 0.0) return 0.0;
    ivec2 low = ivec2(floor(at));
    vec2 share = at - vec2(low);
    float visible = 0.0;
    for (int i = 0; i < 4; ++i) {
        ivec2 corner = ivec2(i & 1, i >> 1);
        vec2 weight = mix(1.0 - share, share, vec2(corner));
        if (!texel_blocks(low + corner, lifted, depth, radius)) visible += weight.x * weight.y;
    }
    return visible;
}
