// Temporal reuse: averages the irradiance of a pixel with that of the same point in the last frame, which is found by
// projection (reverse reprojection: Nehab, Sander, Lawrence, Tatarchuk, Isidoro 2007). Irradiance depends neither on
// the viewer nor on textures. Of the four pixels around the projected point those count that show its surface; if
// none does, only the light of this frame is used. While the VPLs are kept, the average is over camera positions, in
// which the patterns of interleaved tiles cancel.
#include "gi/engines/vpl/bindings.h"
#include "gi/engines/vpl/shading/merging.h"
#include "gi/engines/vpl/shading/pixel.glsl"

layout(binding = kUnitHistory) uniform samplerBuffer last_light;      // irradiance, W/m^2; w: number of frames
layout(binding = kUnitHistorySurfaces) uniform usamplerBuffer last_surfaces;  // depth, normal
layout(std430, binding = kBindHistory) writeonly buffer NextLight { vec4 next_light[]; };
layout(std430, binding = kBindHistorySurfaces) writeonly buffer NextSurfaces { uvec2 next_surfaces[]; };

uniform CameraView last_camera;
uniform float most_frames;  // largest number of frames in an average; 0: there is no last frame

// Returns irradiance and number of frames of a point in the last frame; 0 frames if it did not see the point.
vec4 last_known(vec3 position, vec3 normal) {
    float depth;
    vec2 size = vec2(last_camera.width, last_camera.height);
    vec2 place = view_place(last_camera, position, depth);
    bool outside = any(lessThanEqual(place, vec2(0.0))) || any(greaterThanEqual(place, size));
    if (most_frames <= 0.0 || !(depth > 0.0) || outside) return vec4(0.0);
    vec2 at = place - 0.5;
    vec2 corner = floor(at), share = at - corner;
    float pixel_width = pixel_height(last_camera, depth);
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int i = 0; i < 4; ++i) {
        vec2 step = vec2(i & 1, i >> 1);
        ivec2 pixel = ivec2(corner + step);
        if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, ivec2(size)))) continue;
        int index = pixel.y * int(last_camera.width) + pixel.x;
        uvec2 surface = texelFetch(last_surfaces, index).xy;
        float there = uintBitsToFloat(surface.x);
        vec3 seen = view_point(last_camera, vec2(pixel) + 0.5, there);
        bool same = there > 0.0 && abs(dot(normal, seen - position)) < kSamePlane * pixel_width &&
                    dot(decode_octahedral(surface.y), normal) > kSameNormal;
        if (!same) continue;  // the light of an empty pixel is undefined
        vec2 near = mix(1.0 - share, share, step);
        sum += near.x * near.y * texelFetch(last_light, index);
        weights += near.x * near.y;
    }
    return weights > kLeastEvidence ? sum / weights : vec4(0.0);
}

vec3 with_history(uint index, Receiver receiver, GBufferTexel texel, vec3 irradiance) {
    vec4 known = last_known(receiver.position, receiver.normal);
    float frames = min(known.w, most_frames - 1.0) + 1.0;
    vec3 light = known.w > 0.0 ? known.xyz + (irradiance - known.xyz) / frames : irradiance;
    next_light[index] = vec4(light, known.w > 0.0 ? frames : 1.0);
    next_surfaces[index] = uvec2(floatBitsToUint(texel.depth), texel.normal);
    return light;
}
