// Shadow maps of directions of the sky, shared by C++ and GLSL (std430): where they show a point, what their
// texels hold, and what blocks a point.
#ifndef LUCARNE_GI_ENGINES_VPL_SHADING_SKY_MAP_H
#define LUCARNE_GI_ENGINES_VPL_SHADING_SKY_MAP_H

#include "gi/engines/vpl/shadow_maps/texel.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi::vpl {
#endif

// A parallel view along one direction of the sky. The map coordinates of a point p, in texels, are
// dot(p, across.xyz) + across.w and the same with `down`; its depth, m, is dot(p, away.xyz) + away.w.
LUCARNE_STRUCT(SkyMap) {
    vec4 across, down;  // xyz: unit vectors over the texel's size, 1/m
    vec4 away;          // xyz: unit, the way the light goes
    vec4 irradiance;    // rgb: of a surface that faces the light, W/m^2
    uint columns, rows,
        first;       // texels along its sides; the number of its first texel among those of all maps
    float farthest;  // the depth beyond which there is no receiver, m
};

// A texel is empty (kNothing) or depth | radius of the surfel | normal, 16 + 4 + 12 bits: the depth in steps
// that are the same for all maps, the rest as map_surface() codes it, with a normal in world space that faces
// the light. The smallest code is the nearest.
LUCARNE_CONST float kSkyDepthSteps = 65534.0f;
// Discs that the light sees at less than this cosine are left out: their depth within a texel is unbounded.
LUCARNE_CONST float kSkyEdgeOn = 1e-3f;
// Casters have their radii in steps of 2^(1/6) (casters.glsl): by half a step more no disc is too small,
// which would open holes between the discs of an even pattern.
LUCARNE_CONST float kSkyRadius = 1.0595f;

LUCARNE_FN uint pack_sky_texel(float depth, float depth_step, uint surface) {
    return uint(clamp(depth / depth_step, 0.0f, kSkyDepthSteps)) << 16 | surface;
}
LUCARNE_FN vec3 sky_place(SkyMap map, vec3 position) {
    return vec3(dot(position, xyz_of(map.across)) + map.across.w,
                dot(position, xyz_of(map.down)) + map.down.w, dot(position, xyz_of(map.away)) + map.away.w);
}

// Returns the texel that shows a place; places outside the map belong to its border.
LUCARNE_FN vec2 sky_corner(SkyMap map, vec2 place) {
    return clamp(floor(place), vec2(0.0f), vec2(float(map.columns), float(map.rows)) - 1.0f);
}
LUCARNE_FN uint sky_texel_index(SkyMap map, vec2 corner) {
    return map.first + uint(corner.y) * map.columns + uint(corner.x);
}

// Returns the way from a receiver to the point that is looked up. The point is lifted off the surface by the
// radius of the surfel, as the rays of the reference start (gi/engines/reference/README.md), but by a
// texel at least, so that a wall in the light's plane does not find what lies beside it.
// It also comes a radius nearer to the viewer, where there is air: the rim of a floor's disc that sticks out
// below a wall must not be lit from outside.
LUCARNE_CONST float kSkyLift = 1.0f;  // texels
LUCARNE_FN float sky_lift(SkyMap map, float radius) {
    float across = dot(xyz_of(map.across), xyz_of(map.across)),
          down = dot(xyz_of(map.down), xyz_of(map.down));
    return max(radius, kSkyLift * inversesqrt(min(across, down)));
}
LUCARNE_FN vec3 sky_moved(SkyMap map, vec3 normal, vec3 to_viewer, float radius) {
    return normal * sky_lift(map, radius) + to_viewer * radius;
}

// What a texel says about the light of a receiver.
LUCARNE_CONST uint kSkyClear = 0u;            // it shows the receiver's own surface, or one behind it
LUCARNE_CONST uint kSkyUnsure = 1u;           // it is empty, or shows another surface beside the receiver
LUCARNE_CONST uint kSkyBlocks = 2u;           // it shows a surface that blocks the light
LUCARNE_CONST float kSkyOwn = 0.5f;           // least cosine between the normals of one surface
LUCARNE_CONST float kSkyNormalError = 0.07f;  // sine of the error of a texel's normal

// Returns what a texel says. `place` is the sky_place() of the point that is looked up, `moved` the way there
// from the receiver, `corner` the texel's. Surfaces are planes, as for VPLs (vpl_sees() in gather.glsl): a
// blocker lies in front of the plane of the receiver, and the receiver behind the plane of the blocker.
LUCARNE_FN uint sky_verdict(SkyMap map, uint texel, vec2 corner, vec3 place, float depth_step, vec3 normal,
                            float radius, vec3 moved) {
    if (texel == kNothing) return kSkyUnsure;
    vec3 across = xyz_of(map.across), down = xyz_of(map.down);
    vec2 apart = corner + 0.5f - vec2(place.x, place.y);
    vec3 offset = across * (apart.x / dot(across, across)) + down * (apart.y / dot(down, down)) +
                  xyz_of(map.away) * ((float(texel >> 16) + 0.5f) * depth_step - place.z);
    vec3 facing = map_normal(texel);
    float lift = dot(normal, moved), height = dot(normal, offset) + lift, front = dot(facing, offset);
    float error = kRimPush * max(radius, map_radius(texel)) + kSkyNormalError * length(offset);
    if (height > radius) return front < -error ? kSkyClear : kSkyBlocks;
    return height > -radius && dot(normal, facing) < kSkyOwn ? kSkyUnsure : kSkyClear;
}

// Returns the neighbour of a texel on the side where the place lies, along one axis.
LUCARNE_FN float sky_neighbour(float corner, float place, float count) {
    return clamp(place - corner < 0.5f ? corner - 1.0f : corner + 1.0f, 0.0f, count - 1.0f);
}

#ifdef __cplusplus
static_assert(sizeof(SkyMap) == 80);
}  // namespace lucarne::gi::vpl
#endif
#endif
