// The importance map of the light G-buffer with its mip chain, and the warp that samples it.
//
// A texel holds (weight, lit): the VPLs should be proportional to weight; lit is 1 where light lands on a surface.
// Level 0 has `importance_side` (a power of two) texels along a side. Each higher level sums 2 x 2 texels of the
// level below. All levels lie one after the other in one buffer.

#include "gi/engines/vpl/bindings.h"
#include "gi/lighting/shadow.glsl"
#include "gi/shared/light.h"

layout(std430, binding = kBindImportance) buffer Importance { vec2 importance[]; };

uniform uint importance_side;
uniform Light light;
uniform uint face;  // the face of the light that light_view shows

// The share of the VPLs that is spread evenly over all lit texels. No lit texel then has zero probability, and the
// estimate stays unbiased (a surface of luminance 0 may still be glossy at some wavelength).
const float kUniformShare = 0.05;

uint importance_level(uint level) {  // index of the first texel of a level
    uint first = 0u;
    for (uint l = 0u; l < level; ++l) first += (importance_side >> l) * (importance_side >> l);
    return first;
}

// Returns what leaves the pinhole of the view in a unit direction, W/sr, toward a surface at a squared distance. The
// pinhole of a directional light is so far away that its irradiance spreads like the flux through the solid angle.
vec3 view_intensity(vec3 away, float distance2) {
    if (light.kind == kDirectionalLight) {
        vec3 offset = light_view.origin.xyz + away * sqrt(distance2) - light.position.xyz;
        return light_face(light, offset) == face ? light.strength.xyz * distance2 : vec3(0.0);
    }
    if (light_face(light, away) != face) return vec3(0.0);
    return light_intensity(light, away);
}

// Returns the solid angle of one pixel of the light's view about the point `at` (pixels): dA cos^3 at unit depth, sr.
float ray_solid_angle(vec2 at) {
    float pixels = float(light_view.width) * float(light_view.height);
    float pixel_area = 4.0 * length(light_view.right.xyz) * length(light_view.up.xyz) / pixels;
    vec3 ray = view_ray(light_view, at);
    float cosine = inversesqrt(dot(ray, ray));
    return pixel_area * cosine * cosine * cosine;
}

struct WarpedPoint {
    vec2 at;            // in texels of level 0
    float probability;  // of its texel; 0 if the map is empty
};

// Hierarchical warping (Clarberg, Jarosz, Akenine-Moller, Jensen 2005, section 3.2). From the coarsest level down the
// point is assigned to one of the two rows of a 2 x 2 block by their sums, then to one of the two texels of that row.
// The remainder is rescaled to [0, 1) and goes on to the next level.
WarpedPoint warp(vec2 point) {
    WarpedPoint result;
    result.at = vec2(0.0);
    result.probability = 0.0;
    uint levels = uint(findMSB(importance_side));
    vec2 total = importance[importance_level(levels)];
    if (!(total.x + total.y > 0.0)) return result;
    // Both parts are normalised by their sums. A map without any weight (all black) is sampled evenly.
    vec2 mix_factors = total.x > 0.0 ? vec2((1.0 - kUniformShare) / total.x, kUniformShare / total.y)
                                     : vec2(0.0, 1.0 / total.y);
    uvec2 cell = uvec2(0u);
    float probability = 1.0;
    for (uint l = levels; l-- > 0u;) {
        uint side = importance_side >> l;
        uint base = importance_level(l) + 2u * cell.y * side + 2u * cell.x;
        vec2 upper = vec2(dot(importance[base], mix_factors), dot(importance[base + 1u], mix_factors));
        vec2 lower = vec2(dot(importance[base + side], mix_factors), dot(importance[base + side + 1u], mix_factors));
        vec2 rows = vec2(upper.x + upper.y, lower.x + lower.y);
        float split_y = rows.x / (rows.x + rows.y);
        bool down = point.y >= split_y;
        point.y = down ? (point.y - split_y) / (1.0 - split_y) : point.y / split_y;
        vec2 row = down ? lower : upper;
        float split_x = row.x / (row.x + row.y);
        bool right = point.x >= split_x;
        point.x = right ? (point.x - split_x) / (1.0 - split_x) : point.x / split_x;
        point = clamp(point, vec2(0.0), vec2(0.99999994));
        cell = 2u * cell + uvec2(right ? 1u : 0u, down ? 1u : 0u);
        probability = right ? row.y : row.x;
    }
    result.at = vec2(cell) + point;
    result.probability = probability;
    return result;
}
