// What the VPLs send to a point: the sum that shading and the merge's repairs have in common.
#include "gi/shared/brdf.h"
#include "gi/shared/gbuffer.h"
#include "gi/vpl/parabolic.glsl"
#include "gi/vpl/vpl_light.h"

layout(std430, binding = 9) readonly buffer Lights { VplLight lights[]; };

struct Receiver {
    vec3 position;
    vec3 normal;
    float radius;    // of its surfel, m
    vec3 to_viewer;  // unit
    Reflectance reflectance;
};

struct Gathered {
    vec3 irradiance;  // W/m^2: free of the receiver's albedo
    vec3 specular;    // W/(sr m^2) toward the viewer by the receiver's lobe
};

// Whether VPL `index` sees the receiver by its shadow map, `normal` being the receiver's. What the map holds in the
// receiver's direction is a blocker if the receiver lies behind the blocker's plane, and the blocker before the
// receiver's plane, both by more than the map can tell. A texel is coarse, and depths alone would let slanted surfaces and
// the walls of a corner shadow each other over its whole width.
bool vpl_sees(uint index, vec3 light_normal, vec3 lifted, vec3 normal) {
    mat3 frame = frame_about(light_normal);
    vec3 receiver = (lifted - light_normal * lights[index].incident.w) * frame;
    if (receiver.z <= 0.0) return true;
    uvec2 at = texel_at(map_coordinates(normalize(receiver)));
    uint nearest = atlas[texel_index(index, at)];
    vec2 uv = texel_centre(at);
    float blocker_distance = map_distance(nearest);
    vec3 blocker = map_ray(uv) * (blocker_distance / (1.0 + dot(uv, uv)));
    float tolerance = map_tolerance(map_radius(nearest), blocker_distance);
    return nearest == kNothing || dot(normal * frame, blocker - receiver) <= tolerance ||
           dot(map_normal(nearest), blocker - receiver) <= tolerance;
}

// Points of one plane do not light each other, whichever side they are on: positions are rounded, and the G-buffer lets
// the rim of a disc stick out of what hides it by a share of its radius (kRimPush). A lamp on the roof would shine at
// the ceiling under it.

// Every `stride`-th VPL from `first` on. Each is a disc of area A rather than a point: G = cos cos' / sqrt(d^4 + (A/pi)^2)
// agrees with a disc's form factor where the receiver touches it (pi/A) and with a point's elsewhere. The usual
// 1 / (d^2 + A/pi) has the same limits and loses two to three times as much energy between them (README.md).
Gathered gather(Receiver receiver, uint first, uint stride, uint count) {
    Gathered sum = Gathered(vec3(0.0), vec3(0.0));
    for (uint i = first; i < count; i += stride) {
        vec4 position = lights[i].position;
        vec4 light_normal = lights[i].normal;
        vec3 offset = receiver.position - position.xyz;
        float cosines = -dot(receiver.normal, offset);
        float light_cosine = dot(light_normal.xyz, offset);
        if (!(min(cosines, light_cosine) > kRimPush * receiver.radius)) continue;  // also the dead
        float distance2 = dot(offset, offset);
        if (!vpl_sees(i, light_normal.xyz, offset + receiver.normal * receiver.radius, receiver.normal)) continue;
        float geometry = cosines * light_cosine / (distance2 * length(vec2(distance2, position.w / kPi)));
        vec4 diffuse = lights[i].diffuse;
        vec3 arriving = diffuse.xyz;
#ifdef LUCARNE_GLOSSY
        vec3 direction = offset * inversesqrt(distance2);
        Reflectance source;
        source.kd = vec3(0.0);
        source.ks = light_normal.w;
        source.exponent = diffuse.w;
        arriving += lights[i].flux.xyz * specular_brdf(source, light_normal.xyz, lights[i].incident.xyz, direction);
        sum.specular += arriving * geometry *
                        specular_brdf(receiver.reflectance, receiver.normal, -direction, receiver.to_viewer);
#endif
        sum.irradiance += arriving * geometry;
    }
    return sum;
}
