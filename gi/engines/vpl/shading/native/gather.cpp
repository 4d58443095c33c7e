#include "gi/engines/vpl/shading/native/gather.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

#include "gi/engines/vpl/shading/separation.h"
#include "gi/engines/vpl/shadow_maps/native/map_frame.h"
#include "gi/engines/vpl/shadow_maps/splats.h"
#include "gi/shared/brdf.h"
#include "io/core/parallel.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/engines/vpl/shading/native/gather.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/engines/vpl/shading/native/interleaved-inl.h"
#include "gi/engines/vpl/shadow_maps/native/texel-inl.h"

#ifndef LUCARNE_NATIVE_GATHER_ONCE
#define LUCARNE_NATIVE_GATHER_ONCE
namespace lucarne::gi::vpl::native {

/// A VPL with the frame of its map.
struct GatherLight {
    glm::vec4 normal, tangent, bitangent;
    glm::vec3 position;  ///< relative to the camera
    glm::vec3 diffuse;
    float r2, per_area;  ///< squared radius of the footprint, and 1 / its area
    size_t map;          ///< its first texel in the atlas
};

struct GatherJob {
    const GatherInput& input;
    std::span<const GatherLight> lights;
    float texels, texel, width;  ///< of a map: along a side; a texel's side; its angle
};

inline GatherLight gather_light(const VplLight& light, const glm::vec4& eye, size_t map) {
    const MapFrame frame = frame_of(light);
    const float r2 = std::max(light.position.w / kPi, 1e-12f);
    return {frame.normal,
            frame.tangent,
            frame.bitangent,
            glm::vec3(light.position) - glm::vec3(eye),
            glm::vec3(light.diffuse),
            r2,
            1 / (kPi * r2),
            map};
}

}  // namespace lucarne::gi::vpl::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {

/// Some pixels as receivers.
struct Receivers {
    V3 position, normal;
    F radius, per_radius;
};

// Divisions are slow, so quotients share them. The common denominators are finite for distances up to 1e9 m.

/// A VPL and some pixels.
struct Pair {
    V3 offset;      ///< from the VPL
    F d2;           ///< its square
    F own, height;  ///< heights of the VPL over the planes of the pixels, and of them over its plane
    F cosine;       ///< between the normals
};
HWY_INLINE Pair pair_of(const GatherLight& light, const Receivers& to) {
    const V3 offset{sub(to.position.x, set(light.position.x)), sub(to.position.y, set(light.position.y)),
                    sub(to.position.z, set(light.position.z))};
    return {offset, dot(offset, offset), hn::Neg(dot(to.normal, offset)), dot(offset, light.normal),
            dot(to.normal, light.normal)};
}

/// pair_share() of gather.glsl, with separate_share(), for points that face each other.
HWY_INLINE F pair_share(const Receivers& to, const Pair& pair) {
    const F clearance = mul(hn::Min(pair.own, pair.height), to.per_radius),
            most = hn::Max(pair.own, pair.height), distance = hn::Sqrt(pair.d2);
    const F opposite = clamped(hn::Neg(pair.cosine));
    const auto mixed = [&](float a, float b) { return add(set(a), mul(set(b - a), opposite)); };
    const F width = mixed(kClearRange, kClearRangeFacing),
            rise_width = mul(mixed(kRiseRange, kRiseRangeFacing), distance);
    const F per_widths = over(set(1.0f), mul(width, rise_width));
    const F clear = mul(sub(clearance, mixed(kClear, kClearFacing)), mul(rise_width, per_widths)),
            risen = mul(sub(most, mul(mixed(kRise, kRiseFacing), distance)), mul(width, per_widths));
    return mul(clamped(clear), clamped(risen));
}

/// disc_form_factor() of gather.glsl. The normal of the light is perpendicular to `lateral`, so the flux, a
/// sum of both, needs no vectors.
HWY_INLINE F disc_form_factor(const GatherLight& light, const Pair& pair) {
    const F zero = hn::Zero(Floats()), one = set(1.0f), r2 = set(light.r2), height = pair.height;
    const F a2 = sub(pair.d2, mul(height, height)), sum = add(pair.d2, r2), apart = sub(pair.d2, r2);
    const F s = hn::Sqrt(hn::Max(sub(mul(sum, sum), mul(a2, set(4 * light.r2))), set(1e-30f)));
    // parallel = 2 height^2 r2 / (s (s + d2 - r2)) outside, (s + r2 - d2) / (2 s) inside;
    // lateral_share = 2 height r2 / (s (d2 + r2 + s))
    const Mask outside = hn::Gt(apart, zero);
    const F beyond = hn::IfThenElse(outside, add(s, apart), one), around = add(sum, s);
    const F per_s = over(one, s), per_both = mul(over(one, mul(beyond, around)), per_s);
    const F reach = mul(height, set(2 * light.r2));
    const F parallel = hn::IfThenElse(outside, mul(mul(reach, height), mul(around, per_both)),
                                      mul(mul(set(0.5f), sub(s, apart)), per_s));
    const F lateral_share = mul(reach, mul(beyond, per_both));
    // The lateral part of the offset leads away from the light; `toward` is its negative dot product with the
    // normal of the receiver.
    const F toward = add(pair.own, mul(height, pair.cosine));
    const F facing = sub(mul(lateral_share, toward), mul(parallel, pair.cosine));
    const F size2 = add(mul(parallel, parallel), mul(mul(lateral_share, lateral_share), a2));
    // cut = size (cosine + sine)^2 / (4 sine) or facing, lossless = (size^2 + facing) / (size + 1), where
    // cosine = facing / size
    const F size = hn::Sqrt(hn::Max(size2, set(1e-36f))), steep = mul(size, hn::Sqrt(size));
    const F above = hn::Max(add(facing, steep), zero);
    const F four_steep = mul(set(4.0f), steep), more = add(size, one);
    const F per_steep = over(one, mul(four_steep, more));
    const F partly = mul(mul(above, above), mul(more, per_steep));
    const F cut = hn::IfThenElse(hn::Ge(facing, steep), facing, partly);
    const F lossless = hn::Max(mul(add(mul(size, size), facing), mul(four_steep, per_steep)), zero);
    return mul(set(kPi * 0.5f), add(cut, lossless));
}

/// The normals that a map's texels hold, unnormalised: map_normal() of texel.h without its rounding to 16
/// bits.
HWY_INLINE V3 blocker_normals(U texel) {
    const auto fraction = [&](U bits) {
        return sub(mul(to_float(hn::And(bits, word(63))), set(2 / 63.0f)), set(1.0f));
    };
    const F x = fraction(texel), y = fraction(hn::ShiftRight<6>(texel));
    const F z = sub(sub(set(1.0f), hn::Abs(x)), hn::Abs(y));
    const F fold = hn::Max(hn::Neg(z), hn::Zero(Floats()));
    return {sub(x, hn::CopySign(fold, x)), sub(y, hn::CopySign(fold, y)), z};
}

/// vpl_sees() of gather.glsl.
HWY_INLINE Mask sees(const GatherJob& job, const GatherLight& light, const Pair& pair, const Receivers& to,
                     Mask lit) {
    const Ints di;
    const GatherInput& input = job.input;
    const F zero = hn::Zero(Floats()), one = set(1.0f);
    // In the frame of the map: the normal, and the point a radius above its surface.
    const V3 normal{dot(to.normal, light.tangent), dot(to.normal, light.bitangent), pair.cosine};
    const V3 receiver{add(dot(pair.offset, light.tangent), mul(normal.x, to.radius)),
                      add(dot(pair.offset, light.bitangent), mul(normal.y, to.radius)),
                      sub(add(pair.height, mul(normal.z, to.radius)), set(light.normal.w))};
    const F half = set(0.5f * job.texels);
    const F scale = over(half, add(hn::Sqrt(dot(receiver, receiver)), receiver.z));
    const auto texel = [&](F v) {
        const F at = add(mul(v, scale), half);
        return to_int(di, hn::IfThenElseZero(lit, hn::Min(hn::Max(at, zero), set(job.texels - 1))));
    };
    const auto column = texel(receiver.x), row = texel(receiver.y);
    const auto index = hn::Add(hn::Mul(row, hn::Set(di, static_cast<int32_t>(input.side))), column);
    const U nearest = hn::BitCast(
        Words(), hn::GatherIndex(di, reinterpret_cast<const int32_t*>(input.atlas) + light.map, index));
    const auto centre = [&](hn::Vec<Ints> at) {
        return add(mul(hn::ConvertTo(Floats(), at), set(job.texel)), set(0.5f * job.texel - 1));
    };
    const F u = centre(column), v = centre(row), uv2 = add(mul(u, u), mul(v, v));
    const F distance = map_distances(Words(), nearest), along = over(distance, add(one, uv2));
    const F twice = add(along, along);
    const V3 ahead{sub(mul(u, twice), receiver.x), sub(mul(v, twice), receiver.y),
                   sub(mul(sub(one, uv2), along), receiver.z)};
    const V3 blocker = blocker_normals(nearest);
    const F length = hn::Sqrt(dot(blocker, blocker));
    const F radius = map_radii(Words(), nearest);
    const F error = mul(set(kSheetTolerance), hn::Max(radius, mul(set(input.splat_angle), distance)));
    const F width = mul(set(job.width), distance);
    // Both sides of the test against the blocker's plane are times the length of its normal.
    const F behind = add(mul(add(error, width), length), mul(width, hn::Max(dot(normal, blocker), zero)));
    Mask seen = hn::Or(hn::Le(receiver.z, zero), hn::RebindMask(Floats(), hn::Eq(nearest, word(kNothing))));
    seen = hn::Or(seen, hn::Le(dot(normal, ahead), error));
    seen = hn::Or(seen, hn::Le(dot(blocker, ahead), behind));
    return hn::And(lit, seen);
}

/// Adds the light of a VPL to the lanes of a mask.
HWY_INLINE void add_vpl(const GatherJob& job, const GatherLight& light, const Receivers& to, Mask lanes,
                        V3& sum) {
    const Pair pair = pair_of(light, to);
    // Most VPLs that a pixel cannot see lie behind it, or it behind them.
    Mask lit = hn::And(lanes, hn::Gt(hn::Min(pair.own, pair.height), mul(set(kRimPush), to.radius)));
    if (hn::AllFalse(Floats(), lit)) return;
    const F share = pair_share(to, pair);
    lit = hn::And(lit, hn::Gt(share, hn::Zero(Floats())));
    if (hn::AllFalse(Floats(), lit)) return;
    lit = sees(job, light, pair, to, lit);
    if (hn::AllFalse(Floats(), lit)) return;
    const F factor =
        hn::IfThenElseZero(lit, mul(mul(share, disc_form_factor(light, pair)), set(light.per_area)));
    sum = {add(sum.x, mul(set(light.diffuse.x), factor)), add(sum.y, mul(set(light.diffuse.y), factor)),
           add(sum.z, mul(set(light.diffuse.z), factor))};
}

/// The VPLs as Batch takes them.
struct VplLights {
    static constexpr size_t kTogether = 16;
    using Receivers = native::HWY_NAMESPACE::Receivers;
    const GatherJob& job;

    size_t count() const { return job.lights.size(); }
    Receivers receivers(const V3& position, const V3& normal, F radius) const {
        return {position, normal, radius, hn::Div(set(1.0f), radius)};
    }
    HWY_INLINE void add(size_t number, const Receivers& to, Mask lanes, V3& sum) const {
        add_vpl(job, job.lights[number], to, lanes, sum);
    }
};

void GatherRows(const InterleavedPicture& picture, const GatherJob& job, int first, int end) {
    light_rows(picture, VplLights{job}, first, end);
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::vpl::native {

HWY_EXPORT(GatherRows);
void gather(const GatherInput& input, uint32_t n, const GatherOutput& output) {
    std::vector<GatherLight> lights;
    for (const VplLight& light : input.lights)
        lights.push_back(gather_light(light, input.camera.origin, lights.size() * input.side * input.side));
    const auto texels = static_cast<float>(input.side);
    const GatherJob job{input, lights, texels, 2 / texels, map_texel_angle(texels)};
    const InterleavedPicture picture{input.camera, input.texels, static_cast<int>(n), output};
    parallel_ranges(input.camera.height, 32, [&](size_t first, size_t end) {
        HWY_DYNAMIC_DISPATCH(GatherRows)(picture, job, static_cast<int>(first), static_cast<int>(end));
    });
}

}  // namespace lucarne::gi::vpl::native
#endif
