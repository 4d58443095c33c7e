// What the VPLs send to a point: the sum that shading and the merge's repairs have in common.
#include "gi/shared/gbuffer.h"
#include "gi/engines/vpl/lights.glsl"
#include "gi/engines/vpl/shadow_maps/parabolic.glsl"

layout(binding = 5) uniform usamplerBuffer atlas_texels;

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
bool vpl_sees(uint index, vec4 light_normal, vec3 lifted, vec3 normal) {
    mat3 frame = frame_about(light_normal.xyz);
    vec3 receiver = (lifted - light_normal.xyz * light_normal.w) * frame;
    uvec2 at = texel_at(map_coordinates(normalize(receiver)));
    uint nearest = texelFetch(atlas_texels, int(texel_index(index, at))).x;
    vec2 uv = texel_centre(at);
    float blocker_distance = map_distance(nearest);
    vec3 blocker = map_ray(uv) * (blocker_distance / (1.0 + dot(uv, uv)));
    float tolerance = map_tolerance(map_radius(nearest), blocker_distance);
    return receiver.z <= 0.0 || nearest == kNothing || dot(normal * frame, blocker - receiver) <= tolerance ||
           dot(map_normal(nearest), blocker - receiver) <= tolerance;
}

// The form factor, times pi, from a point to a disc of squared radius r2 whose centre lies at -offset, that is pi times
// what a disc of unit radiosity sends there. In the plane of the disc's normal and the offset the light's vector has
// closed form (Howell, catalogue of radiation configuration factors, B-12 and B-13: elements parallel and perpendicular
// to a disc), here without their cancellations far away. What of the disc lies behind the receiver's plane counts
// partly: half as a sphere of the same solid angle is cut off there (a parabola through the ends of the exact formula,
// at most 2 % of the whole off), and half without a loss (after Hill: (l^2 + z) / (l + 1)). For a disc that crosses
// the plane stands for surface that ends there, and a loss of all of it makes every corner dark: README.md.
float disc_form_factor(vec3 normal, vec3 light_normal, vec3 offset, float r2) {
    float height = dot(light_normal, offset);
    vec3 lateral = offset - height * light_normal;
    float a2 = dot(lateral, lateral);
    float d2 = dot(offset, offset);
    float s = sqrt(max((d2 + r2) * (d2 + r2) - 4.0 * a2 * r2, 1e-30));
    float parallel = d2 > r2 ? 2.0 * height * height * r2 / (s * (s + d2 - r2)) : 0.5 * (s + r2 - d2) / s;
    float lateral_share = 2.0 * height * r2 / (s * (d2 + r2 + s));
    vec3 flux = -parallel * light_normal - lateral_share * lateral;
    float size = max(length(flux), 1e-30);
    float facing = dot(flux, normal);
    float sine = sqrt(size);
    float cosine = facing / size;
    float above = max(cosine + sine, 0.0);
    float cut = cosine >= sine ? facing : size * above * above / (4.0 * sine);
    return kPi * 0.5 * (cut + max((size * size + facing) / (size + 1.0), 0.0));
}

// What VPL `i` sends to a receiver where nothing is in between. Each VPL is a disc of its footprint A: as one, it sends
// what its surface would to what is near, where a point would be without bounds. Lobes: lobes.glsl.
//
// Points of one plane do not light each other, whichever side they are on: positions are rounded, and the G-buffer lets
// the rim of a disc stick out of what hides it by a share of its radius (kRimPush). A lamp on the roof would shine at
// the ceiling under it.
struct Arriving {
    Gathered light;
    bool any;
};

// cos cos' / d^2 of two points, 1/m^2; 0 where they are of one plane, `offset` being the way from the VPL; also for the dead.
float point_geometry(vec3 light_normal, vec3 offset, Receiver receiver) {
    float cosines = -dot(receiver.normal, offset);
    float light_cosine = dot(light_normal, offset);
    if (!(min(cosines, light_cosine) > kRimPush * receiver.radius)) return 0.0;
    float distance2 = dot(offset, offset);
    return cosines * light_cosine / (distance2 * distance2);
}

#ifdef LUCARNE_GLOSSY
// The same with lobes: what the receiver's sees of the VPL, and what the VPL's sends (a receiver's lobe sees the VPL's in
// those directions alone that it reflects).
Gathered with_lobes(uint i, Receiver receiver, vec3 light_normal, vec3 offset, float form_factor) {
    vec4 diffuse = vpl_diffuse(i);
    vec4 incident = vpl_incident(i);
    float r2 = max(vpl_position(i).w / kPi, 1e-12);
    float distance2 = dot(offset, offset);
    float near = inversesqrt(distance2);
    Cone away = vpl_cone(i, offset * near, dot(light_normal, offset) * near, distance2);
    float variance = footprint_gaussian(r2);
    Gathered light = Gathered(diffuse.xyz * form_factor, vec3(0.0));
    if (incident.w > 0.0) {
        vec3 axis = reflect(incident.xyz, light_normal);
        light.irradiance += vpl_flux(i).xyz * incident.w *
                            lobe_sees(axis, diffuse.w, receiver.normal, light_normal, offset, form_factor, away, variance);
    }
    float ks = receiver.reflectance.ks, exponent = receiver.reflectance.exponent;
    if (ks > 0.0) {
        vec3 axis = reflect(-receiver.to_viewer, receiver.normal);
        float lobe = lobe_sees(axis, exponent, receiver.normal, light_normal, offset, form_factor, away, variance);
        light.specular = ks * lobe * (diffuse.xyz + vpl_lobe(i, light_normal, diffuse.w, seen_by_lobe(away, -axis, exponent)));
    }
    return light;
}
#endif

Arriving from_vpl(uint i, Receiver receiver) {
    Arriving result = Arriving(Gathered(vec3(0.0), vec3(0.0)), false);
    vec4 position = vpl_position(i);
    vec4 light_normal = vpl_normal(i);
    vec3 offset = receiver.position - position.xyz;
    float cosines = -dot(receiver.normal, offset);
    float light_cosine = dot(light_normal.xyz, offset);
    if (!(min(cosines, light_cosine) > kRimPush * receiver.radius)) return result;  // also the dead
    result.any = true;
    float r2 = max(position.w / kPi, 1e-12);
    float clear = clamp((min(cosines, light_cosine) / receiver.radius - kRimPush) / (0.6 - kRimPush), 0.0, 1.0);
    float form_factor = clear * disc_form_factor(receiver.normal, light_normal.xyz, offset, r2) / (kPi * r2);
#ifdef LUCARNE_GLOSSY
    result.light = with_lobes(i, receiver, light_normal.xyz, offset, form_factor);
#else
    result.light.irradiance = vpl_diffuse(i).xyz * form_factor;
#endif
    return result;
}

// Every `stride`-th VPL from `first` on.
Gathered gather(Receiver receiver, uint first, uint stride, uint count) {
    Gathered sum = Gathered(vec3(0.0), vec3(0.0));
    for (uint i = first; i < count; i += stride) {
        Arriving arriving = from_vpl(i, receiver);
        vec3 lifted = receiver.position - vpl_position(i).xyz + receiver.normal * receiver.radius;
        if (!arriving.any || !vpl_sees(i, vpl_normal(i), lifted, receiver.normal)) continue;
        sum.irradiance += arriving.light.irradiance;
        sum.specular += arriving.light.specular;
    }
    return sum;
}
