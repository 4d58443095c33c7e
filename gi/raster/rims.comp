// Turns the normals of rims, and replaces texels of hidden faces (rims.h), one invocation a pixel. The first pass finds
// what each texel shall show; the second (LUCARNE_APPLY) writes it, so that no texel sees what has become of its neighbours.
layout(local_size_x = 64) in;
#include "gi/raster/bindings.h"
#include "gi/raster/one_surface.h"
#include "gi/shared/many_threads.glsl"

layout(std430, binding = kBindTexels) buffer Texels { GBufferTexel texels[]; };
layout(std430, binding = kBindIds) buffer Ids { uint ids[]; };
// For each pixel: bits of a depth, a normal, and the pixel whose colour and material it shows.
layout(std430, binding = kBindCoverage) buffer Shown { uvec4 shown[]; };
uniform CameraView camera;

// The places around a texel, nearest first: the i-th of 8 * kRimSteps.
ivec2 place_around(uint i) {
    int place_of_nine = int(i % 8u) + (i % 8u < 4u ? 0 : 1);
    return (ivec2(place_of_nine % 3, place_of_nine / 3) - 1) << int(i / 8u);
}
bool is_inside(ivec2 at) {
    return at.x >= 0 && at.y >= 0 && at.x < int(camera.width) && at.y < int(camera.height);
}
GBufferTexel texel_at(ivec2 at) {
    return texels[uint(at.y) * camera.width + uint(at.x)];
}
vec3 offset_of(ivec2 at, float depth) {
    return view_offset(camera, vec2(at) + 0.5, depth);
}

// Returns whether most texels of the surface around a texel show its other side.
bool is_rim(ivec2 here, GBufferTexel texel) {
    vec3 place = offset_of(here, texel.depth);
    vec3 normal = stored_normal(texel);
    float pixel = pixel_height(camera, texel.depth);
    int others = 0;  // more than those of the same side
    for (uint i = 0u; i < 8u * kRimSteps; ++i) {
        ivec2 there = here + place_around(i);
        if (!is_inside(there)) continue;
        GBufferTexel other = texel_at(there);
        if (other.depth == 0.0) continue;
        vec3 across = offset_of(there, other.depth) - place;
        if (!is_one_surface(texel, normal, other, across, float(1 << int(i / 8u)) * pixel)) continue;
        others += ((texel.albedo ^ other.albedo) & kTexelFromBehind) != 0u ? 1 : -1;
    }
    return others > 0;
}

// Returns what lies beyond a texel of a hidden face, away from the face in front; or else that face: the texel is moved
// to its plane. `found`: whether the hidden face ends within kRimReach. One that goes on is seen from behind as a whole, and
// stays.
uvec4 beyond(ivec2 here, GBufferTexel texel, vec3 place, ivec2 away, GBufferTexel front, vec3 across, out bool found) {
    uint at = uint(here.y) * camera.width + uint(here.x);
    vec3 normal = stored_normal(texel);
    vec3 ray = view_ray(camera, vec2(here) + 0.5);
    float pixel = pixel_height(camera, texel.depth);
    found = true;
    for (int k = 1; k <= kRimReach; ++k) {
        ivec2 there = here + k * away;
        if (!is_inside(there)) break;
        uint from = uint(there.y) * camera.width + uint(there.x);
        GBufferTexel other = texels[from];
        if (other.depth == 0.0) return uvec4(0u, other.normal, from, 0u);
        vec3 point = offset_of(there, other.depth);
        float reach = float(k) * pixel;
        if (is_one_surface(texel, normal, other, point - place, reach)) {
            if (k == kRimReach) {
                found = false;
                return uvec4(0u);
            }
            continue;
        }
        if (!is_background(other, texel, reach)) break;
        float depth =
            other.depth + depth_to_plane(texel_normal(other), point - offset_of(here, other.depth), ray);
        return uvec4(floatBitsToUint(depth > texel.depth ? depth : other.depth), other.normal, from, 0u);
    }
    float depth = texel.depth + depth_to_plane(texel_normal(front), across, ray);
    found = depth > 0.0;
    return uvec4(floatBitsToUint(depth), front.normal, at, 0u);
}

// Returns what a texel that is seen from behind shall show; itself if it belongs to no hidden face.
uvec4 in_place_of(ivec2 here, GBufferTexel texel) {
    vec3 place = offset_of(here, texel.depth);
    vec3 normal = stored_normal(texel);
    float pixel = pixel_height(camera, texel.depth);
    for (uint i = 0u; i < 8u * kRimSteps; ++i) {
        ivec2 step = place_around(i);
        if (!is_inside(here + step)) continue;
        GBufferTexel front = texel_at(here + step);
        if (front.depth == 0.0) continue;
        vec3 across = offset_of(here + step, front.depth) - place;
        if (!is_over_crease(texel, normal, front, across, float(1 << int(i / 8u)) * pixel)) continue;
        bool found;
        uvec4 result = beyond(here, texel, place, -sign(step), front, across, found);
        if (found) return result;
    }
    return uvec4(floatBitsToUint(texel.depth), texel.normal, uint(here.y) * camera.width + uint(here.x), 0u);
}

void main() {
    uint at = thread_number();
    if (at >= camera.width * camera.height) return;
#ifdef LUCARNE_APPLY
    // What is copied does not change itself, apart from its normal: it is not seen from behind.
    uvec4 now = shown[at];
    if (now.z != at) {
        texels[at].albedo = texels[now.z].albedo;
        texels[at].material = texels[now.z].material;
        ids[at] = ids[now.z];
    }
    texels[at].depth = uintBitsToFloat(now.x);
    texels[at].normal = now.y;
#else
    GBufferTexel texel = texels[at];
    shown[at] = uvec4(floatBitsToUint(texel.depth), texel.normal, at, 0u);
    if (texel.depth == 0.0 || (texel.albedo & kSurfelHasNormal) == 0u) return;
    ivec2 here = ivec2(int(at % camera.width), int(at / camera.width));
    vec3 ray = normalize(view_ray(camera, vec2(here) + 0.5));
    if (may_be_rim(texel, ray) && is_rim(here, texel)) {
        shown[at].y = encode_octahedral(rim_normal(texel, ray));
    } else if ((texel.albedo & kTexelFromBehind) != 0u) {
        shown[at] = in_place_of(here, texel);
    }
#endif
}
