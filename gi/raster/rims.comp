// Turns the normals of rims, and moves texels of hidden faces to the face in front (rims.h), one invocation a pixel. The
// first pass finds the depths and normals of all texels; the second (LUCARNE_APPLY) writes them, so that no texel sees what
// has become of its neighbours.
layout(local_size_x = 64) in;
#include "gi/raster/bindings.h"
#include "gi/raster/one_surface.h"
#include "gi/shared/many_threads.glsl"

layout(std430, binding = kBindTexels) buffer Texels { GBufferTexel texels[]; };
layout(std430, binding = kBindCoverage) buffer Places { uvec2 places[]; };  // bits of a depth, and a normal
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

// Returns a texel of a hidden face (is_over_crease) moved to the face in front: where that face's plane lies, and its
// normal; otherwise the texel as it is. What is shown of a hidden face is a strip: a face that goes on away from the
// crease is seen from behind as a whole, and stays.
uvec2 in_front_face(ivec2 here, GBufferTexel texel) {
    vec3 place = offset_of(here, texel.depth);
    vec3 normal = stored_normal(texel);
    vec3 ray = view_ray(camera, vec2(here) + 0.5);
    float pixel = pixel_height(camera, texel.depth);
    float farthest = float(kRimReach) * pixel;
    for (uint i = 0u; i < 8u * kRimSteps; ++i) {
        ivec2 step = place_around(i);
        float reach = float(1 << int(i / 8u)) * pixel;
        if (!is_inside(here + step)) continue;
        GBufferTexel front = texel_at(here + step);
        if (front.depth == 0.0) continue;
        vec3 across = offset_of(here + step, front.depth) - place;
        if (!is_over_crease(texel, normal, front, across, reach)) continue;
        ivec2 away = here - kRimReach * sign(step);  // where its own surface may go on
        if (is_inside(away)) {
            GBufferTexel beyond = texel_at(away);
            if (beyond.depth != 0.0 &&
                is_one_surface(texel, normal, beyond, offset_of(away, beyond.depth) - place, farthest))
                continue;
        }
        float depth = texel.depth + depth_to_plane(texel_normal(front), across, ray);
        if (depth > 0.0) return uvec2(floatBitsToUint(depth), front.normal);
    }
    return uvec2(floatBitsToUint(texel.depth), texel.normal);
}

void main() {
    uint at = thread_number();
    if (at >= camera.width * camera.height) return;
#ifdef LUCARNE_APPLY
    texels[at].depth = uintBitsToFloat(places[at].x);
    texels[at].normal = places[at].y;
#else
    GBufferTexel texel = texels[at];
    places[at] = uvec2(floatBitsToUint(texel.depth), texel.normal);
    if (texel.depth == 0.0 || (texel.albedo & kSurfelHasNormal) == 0u) return;
    ivec2 here = ivec2(int(at % camera.width), int(at / camera.width));
    vec3 ray = normalize(view_ray(camera, vec2(here) + 0.5));
    if (may_be_rim(texel, ray) && is_rim(here, texel)) {
        places[at].y = encode_octahedral(rim_normal(texel, ray));
    } else if ((texel.albedo & kTexelFromBehind) != 0u) {
        places[at] = in_front_face(here, texel);
    }
#endif
}
