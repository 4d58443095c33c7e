// Whether a spot sees a point: a light G-buffer read as a shadow map.
#include "gi/shared/gbuffer.glsl"

layout(std430, binding = 4) readonly buffer LightTexels { GBufferTexel light_texels[]; };
uniform CameraView light_view;

// True where the surface in this texel of the light's view stands between the light and `position`. Instead of two
// depths, which differ over a texel and give acne, the point is compared with the plane of the caster's disc. Both
// surfaces are known only to about half their discs' radius (scans are noisy, gi/reference/README.md has figures),
// so the point is first lifted off its own surface by half its radius and half the patch that the texel stands for:
// the caster's disc, or the texel where that is larger. Then it has to stand before the caster's plane by as much as
// the G-buffer lets a disc stick out of the surface that hides it, or the rims of walls would catch light from
// outside the room.
bool texel_blocks(ivec2 pixel, vec3 position, vec3 normal, float radius, float depth) {
    pixel = clamp(pixel, ivec2(0), ivec2(light_view.width, light_view.height) - 1);
    GBufferTexel texel = light_texels[uint(pixel.y) * light_view.width + uint(pixel.x)];
    if (texel.depth <= 0.0) return false;
    float caster_radius = texel_radius(texel);
    float footprint = texel.depth * 2.0 * length(light_view.right.xyz) / float(light_view.width);
    vec3 lifted = position + normal * (0.5 * (radius + max(caster_radius, footprint)));
    vec3 caster = texel_position(light_view, uvec2(pixel), texel);
    // The plane has no end but the disc has: what is nearer to the light than the disc reaches is not behind it.
    float margin = kRimPush * max(radius, caster_radius);
    return depth > texel.depth - 2.0 * caster_radius && dot(texel_normal(texel), lifted - caster) < margin;
}

// The share of the light that arrives, 0 to 1: the four nearest texels, weighted bilinearly (percentage-closer
// filtering; Reeves, Salesin & Cook 1987). A texel counts as dark where it or one of its eight neighbours is blocked:
// its own ray may just miss the edge of a roof and hit the wall's rim that sticks out beside it, while the point's ray
// meets the roof. So shadows are one texel wide too large, and no light leaks along the edges of rooms. `normal` faces
// the light; `radius` is that of the point's surfel.
float spot_visibility(vec3 position, vec3 normal, float radius) {
    vec3 offset = position - light_view.origin.xyz;
    float depth = dot(offset, light_view.forward.xyz);
    if (depth <= 0.0) return 0.0;
    vec2 ndc = vec2(dot(offset, light_view.right.xyz) / dot(light_view.right.xyz, light_view.right.xyz),
                    -dot(offset, light_view.up.xyz) / dot(light_view.up.xyz, light_view.up.xyz)) / depth;
    vec2 at = (0.5 * ndc + 0.5) * vec2(light_view.width, light_view.height) - 0.5;
    ivec2 low = ivec2(floor(at));
    vec2 share = at - vec2(low);
    uint blocked = 0u;  // bit 4 y + x: texel low - 1 + (x, y)
    for (int i = 0; i < 16; ++i)
        if (texel_blocks(low - 1 + ivec2(i & 3, i >> 2), position, normal, radius, depth)) blocked |= 1u << i;
    const uint kNeighbourhood = 0x777u;  // the 3 x 3 bits from bit 0 on
    float visible = 0.0;
    for (int i = 0; i < 4; ++i) {
        ivec2 corner = ivec2(i & 1, i >> 1);
        vec2 weight = mix(1.0 - share, share, vec2(corner));
        if ((blocked & kNeighbourhood << (4 * corner.y + corner.x)) == 0u) visible += weight.x * weight.y;
    }
    return visible;
}
