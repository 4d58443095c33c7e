// Computes the ambient obscurance of each pixel from the depths around it: McGuire, Mara & Luebke 2012 ("Scalable
// ambient obscurance", eq. 1 with the falloff of section 2.4). The samples lie on a spiral that is rotated from pixel
// to pixel.
layout(local_size_x = 16, local_size_y = 4) in;
#include "gi/engines/unlit/bindings.h"
#include "gi/engines/unlit/texels.glsl"

layout(std430, binding = kBindObscurance) writeonly buffer Obscurance { float obscurance[]; };
uniform float reach;   // radius of the samples, as a share of the distance to the eye
uniform float relief;  // how much a soft light beside the eye counts, 0 to 1

const int kSpiralSamples = 10;
const float kSpiralTurns = 7.0;
const float kTau = 6.28318531;

// Returns the position of a pixel relative to the eye, metres, along the axes of the world.
vec3 place_of(ivec2 pixel, float depth) {
    return view_point(camera, vec2(pixel) + 0.5, depth) - camera.origin.xyz;
}

// Returns the normal of the plane through the pixel and its neighbours, for points without a normal. On each axis it
// uses the neighbour that is nearer in depth, so that the plane does not cross an edge.
vec3 plane_normal(ivec2 pixel, float depth) {
    vec3 here = place_of(pixel, depth), along[2];
    for (int axis = 0; axis < 2; ++axis) {
        ivec2 step = axis == 0 ? ivec2(2, 0) : ivec2(0, 2);
        float more = texel_at(pixel + step).depth, less = texel_at(pixel - step).depth;
        bool forward = less <= 0.0 || (more > 0.0 && abs(more - depth) <= abs(less - depth));
        along[axis] = forward ? place_of(pixel + step, more > 0.0 ? more : depth) - here
                              : here - place_of(pixel - step, less);
    }
    vec3 normal = cross(along[1], along[0]);
    float length2 = dot(normal, normal);
    normal = length2 > 0.0 ? normal * inversesqrt(length2) : -camera.forward.xyz;
    return dot(normal, toward_viewer(camera, camera.origin.xyz + here)) < 0.0 ? -normal : normal;
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= int(camera.width) || pixel.y >= int(camera.height)) return;
    int index = pixel.y * int(camera.width) + pixel.x;
    GBufferTexel texel = texel_at(pixel);
    float sum = 0.0, light = 1.0;
    if (texel.depth > 0.0) {
        vec3 here = place_of(pixel, texel.depth);
        vec3 normal = (texel.albedo & kSurfelHasNormal) != 0u ? texel_normal(texel) : plane_normal(pixel, texel.depth);
        float sight = sight_distance(texel.depth), radius = reach * sight, radius2 = radius * radius;
        float in_pixels = radius / pixel_height(camera, texel.depth);
        // Each of the 4 x 4 pixels uses another sixteenth of a turn, in an order that makes neighbours differ.
        int turn = ((pixel.x & 3) * 4 + (pixel.y & 3) * 9) & 15;
        for (int i = 0; i < kSpiralSamples; ++i) {
            float part = (float(i) + 0.5) / float(kSpiralSamples);
            float angle = part * kSpiralTurns * kTau + float(turn) * kTau / 16.0;
            ivec2 at = pixel + ivec2(round(part * in_pixels * vec2(cos(angle), sin(angle))));
            float depth = texel_at(at).depth;
            if (!(depth > 0.0)) continue;
            vec3 apart = place_of(clamp(at, ivec2(0), ivec2(camera.width, camera.height) - 1), depth) - here;
            float distance2 = dot(apart, apart);
            float fall = max(radius2 - distance2, 0.0) / radius2;
            // A margin: a surface known to a few thousandths of its distance would darken itself otherwise.
            float over = max(dot(apart, normal) - 0.003 * sight, 0.0);
            sum += fall * fall * fall * over * radius / (distance2 + 1e-4 * radius2);
        }
        // From above the eye, to its left. Half of the light wraps around to what faces away from it.
        vec3 eye = toward_viewer(camera, camera.origin.xyz + here);
        vec3 from = normalize(eye + 0.6 * normalize(camera.up.xyz) - 0.6 * normalize(camera.right.xyz));
        float cosine = dot(normal, from) * (dot(normal, eye) < 0.0 ? -1.0 : 1.0);
        light = 1.0 - relief * (0.5 - 0.5 * cosine);
    }
    float open = 1.0 - min(sum * 5.0 / float(kSpiralSamples), 1.0);
    obscurance[index] = 1.0 - open * light;
}
