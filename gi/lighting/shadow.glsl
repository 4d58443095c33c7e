// Whether a light's view (gi/lighting/light_view.h) sees a point: its G-buffer read as a shadow map.
#include "gi/shared/gbuffer.glsl"

layout(std430, binding = 4) readonly buffer LightTexels { GBufferTexel light_texels[]; };
uniform CameraView light_view;

// Where the light's view shows a point, in texels (centres at .5), and how deep.
vec2 light_pixel(vec3 position, out float depth) {
    vec3 offset = position - light_view.origin.xyz;
    depth = dot(offset, light_view.forward.xyz);
    vec2 ndc = vec2(dot(offset, light_view.right.xyz) / dot(light_view.right.xyz, light_view.right.xyz),
                    -dot(offset, light_view.up.xyz) / dot(light_view.up.xyz, light_view.up.xyz)) / depth;
    return (0.5 * ndc + 0.5) * vec2(light_view.width, light_view.height);
}

GBufferTexel light_texel(inout ivec2 pixel) {
    pixel = clamp(pixel, ivec2(0), ivec2(light_view.width, light_view.height) - 1);
    return light_texels[uint(pixel.y) * light_view.width + uint(pixel.x)];
}

// How far a point is lifted off its surface before it is looked up, as the reference's rays are
// (gi/engines/reference/README.md): by a radius, its own or that of a disc beside it in the map, so that neither noise nor the
// rims of discs that stick out at edges shade or hide it; and by what one look-up blurs together.
float shadow_lift(vec3 position, float radius) {
    float depth;
    ivec2 pixel = ivec2(light_pixel(position, depth));
    float footprint = depth * 2.0 * length(light_view.right.xyz) / float(light_view.width);
    float lift = max(radius, 1.5 * footprint);
    float caster_radius = texel_radius(light_texel(pixel));
    float caster_depth = light_texel(pixel).depth;
    if (caster_depth > 0.0 && abs(caster_depth - depth) < 4.0 * caster_radius) lift = max(lift, caster_radius);
    return lift * (1.0 + kRimPush);  // texel_blocks takes the margin off again
}

// True where the surface in this texel of the light's view stands between the light and the lifted point. Instead of
// two depths, which differ over a texel and give acne, the point is compared with the plane of the caster's disc. It
// has to stand before that plane by as much as the G-buffer lets a disc stick out of the surface that hides it, or the
// rims of walls would catch light from outside the room.
bool texel_blocks(ivec2 pixel, vec3 lifted, float depth, float radius) {
    GBufferTexel texel = light_texel(pixel);
    if (texel.depth <= 0.0) return false;
    float caster_radius = texel_radius(texel);
    vec3 caster = texel_position(light_view, uvec2(pixel), texel);
    // The plane has no end but the disc has: what is nearer to the light than the disc reaches is not behind it.
    float margin = kRimPush * max(radius, caster_radius);
    return depth > texel.depth - 2.0 * caster_radius && dot(texel_normal(texel), lifted - caster) < margin;
}

// The share of the light that arrives, 0 to 1: the four nearest texels, weighted bilinearly (percentage-closer
// filtering; Reeves, Salesin & Cook 1987). `normal` faces the light; `radius` is that of the point's surfel.
float spot_visibility(vec3 position, vec3 normal, float radius) {
    float depth;
    light_pixel(position, depth);
    if (depth <= 0.0) return 0.0;
    vec3 lifted = position + normal * shadow_lift(position, radius);
    vec2 at = light_pixel(lifted, depth) - 0.5;
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
