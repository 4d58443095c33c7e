// Computes the light of the VPLs at a point, for shading and for isolated pixels.
#include "gi/engines/vpl/bindings.h"
#include "gi/shared/disc_form_factor.h"
#include "gi/shared/gbuffer.h"
#include "gi/engines/vpl/lights.glsl"
#include "gi/engines/vpl/shading/receiver.glsl"
#include "gi/engines/vpl/shading/separation.h"
#include "gi/engines/vpl/shadow_maps/parabolic.glsl"

layout(binding = kUnitAtlas) uniform usamplerBuffer atlas_texels;

// Returns whether VPL `index` sees the receiver according to its shadow map; `normal` is that of the receiver. The
// surface that the map holds in the direction of the receiver is a blocker if it lies in front of the plane of the
// receiver and the receiver lies behind its plane. With depths alone, slanted surfaces and the walls of a corner would
// shadow each other over the whole width of a texel.
//   In front: by more than the error of a splat. A texel holds the distance to a plane along its own ray, so surfaces
// of the receiver's own plane lie in that plane, however wide the texel is. More tolerance would let light pass under
// walls: behind a wall, a floor is lit over the foot of that wall.
//   Behind: by a texel more, and by up to two if both surfaces face the same way. Then they may be one curved or noisy
// surface, whose plane changes within the texel.
bool vpl_sees(uint index, vec4 light_normal, vec3 lifted, vec3 normal) {
    mat3 frame = frame_about(light_normal.xyz);
    vec3 receiver = (lifted - light_normal.xyz * light_normal.w) * frame;
    uvec2 at = texel_at(map_coordinates(normalize(receiver)));
    uint nearest = texelFetch(atlas_texels, int(texel_index(index, at))).x;
    vec2 uv = texel_centre(at);
    float blocker_distance = map_distance(nearest);
    vec3 offset = map_ray(uv) * (blocker_distance / (1.0 + dot(uv, uv))) - receiver;
    vec3 blocker_normal = map_normal(nearest);
    vec3 receiver_normal = normal * frame;
    float error = splat_error(map_radius(nearest), blocker_distance);
    float texels = 1.0 + max(dot(receiver_normal, blocker_normal), 0.0);
    return receiver.z <= 0.0 || nearest == kNothing || dot(receiver_normal, offset) <= error ||
           dot(blocker_normal, offset) <= error + texels * texel_width(blocker_distance);
}

// What an unoccluded VPL sends to a receiver. Each VPL is a disc of its footprint A: it sends what its surface would
// send to a near receiver, where a point would be unbounded. Lobes: lobes.glsl.
struct Arriving {
    Gathered light;
    bool any;
};

// Returns separate_share() of a VPL and a point on a surface with this normal and radius of its surfel; `offset` leads from the VPL to
// the point. 0 if one of them does not face the other, and for dead VPLs.
float pair_share(vec3 light_normal, vec3 offset, vec3 normal, float radius) {
    vec2 heights = vec2(-dot(normal, offset), dot(light_normal, offset));
    if (!(min(heights.x, heights.y) > kRimPush * radius)) return 0.0;
    return separate_share(heights, length(offset), radius, dot(light_normal, normal));
}

// Returns cos cos' / d^2 of two points times their pair_share, 1/m^2; `offset` leads from the VPL to the receiver.
float point_geometry(vec3 light_normal, vec3 offset, Receiver receiver) {
    float share = pair_share(light_normal, offset, receiver.normal, receiver.radius);
    if (!(share > 0.0)) return 0.0;
    float distance2 = dot(offset, offset);
    return share * -dot(receiver.normal, offset) * dot(light_normal, offset) / (distance2 * distance2);
}

#ifdef LUCARNE_GLOSSY
// The same with lobes: the light that the receiver's lobe sees of the VPL, and the light of the VPL's lobe (which the
// receiver's lobe sees only in the directions that it reflects).
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
    float share = pair_share(light_normal.xyz, offset, receiver.normal, receiver.radius);
    if (!(share > 0.0)) return result;
    result.any = true;
    float r2 = max(position.w / kPi, 1e-12);
    float form_factor = share * disc_form_factor(receiver.normal, light_normal.xyz, offset, r2) / (kPi * r2);
#ifdef LUCARNE_GLOSSY
    result.light = with_lobes(i, receiver, light_normal.xyz, offset, form_factor);
#else
    result.light.irradiance = vpl_diffuse(i).xyz * form_factor;
#endif
    return result;
}

// Sums the light of every `stride`-th VPL from `first` on.
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
