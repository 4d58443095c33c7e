// What arrives of a light, light.h and shadow.glsl, for vectors of points. Included once for each instruction
// set (Highway's foreach_target.h).
#if defined(LUCARNE_GI_LIGHTING_NATIVE_SHADOWS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LUCARNE_GI_LIGHTING_NATIVE_SHADOWS_INL_H
#undef LUCARNE_GI_LIGHTING_NATIVE_SHADOWS_INL_H
#else
#define LUCARNE_GI_LIGHTING_NATIVE_SHADOWS_INL_H
#endif

#include "gi/lighting/native/emission-inl.h"
#include "gi/lighting/native/light.h"
#include "gi/native/texels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::native::HWY_NAMESPACE {

HWY_INLINE V3 moved(const V3& v, const glm::vec3& by) {
    return {add(v.x, set(by.x)), add(v.y, set(by.y)), add(v.z, set(by.z))};
}

/// light_irradiance() over light.strength; `offset` leads from the light to the points.
HWY_INLINE F irradiance_share(const Light& light, const V3& offset, const V3& normal) {
    const F zero = hn::Zero(Floats());
    if (light.kind == kDirectionalLight) return hn::Max(hn::Neg(dot(normal, light.direction)), zero);
    const F distance2 = dot(offset, offset);
    const V3 away = scaled(offset, over(set(1.0f), hn::Sqrt(distance2)));
    const F share = mul(intensity_share(light, dot(away, light.direction)),
                        over(hn::Max(hn::Neg(dot(normal, away)), zero), distance2));
    return hn::IfThenElseZero(hn::Gt(distance2, zero), share);
}

/// Texels of the light's view at places (middles of texels at .5 less .5), clamped to the picture.
struct ShadowTexels {
    F column, row;
    hn::Vec<Ints> first_word;
};
HWY_INLINE ShadowTexels shadow_texels(const CameraView& view, F column, F row, Mask used) {
    const Ints di;
    const F zero = hn::Zero(Floats());
    const auto clamp = [&](F v, uint32_t size) {
        const F inside = hn::Min(hn::Max(v, zero), set(static_cast<float>(size - 1)));
        return to_int(di, hn::IfThenElseZero(used, inside));
    };
    const auto x = clamp(column, view.width), y = clamp(row, view.height);
    return {hn::ConvertTo(Floats(), x), hn::ConvertTo(Floats(), y),
            hn::ShiftLeft<2>(hn::Add(hn::Mul(y, hn::Set(di, static_cast<int32_t>(view.width))), x))};
}

/// spot_visibility() in shadow.glsl. `position` is relative to the origin of the look; 0 for lanes that are
/// not `lit`.
HWY_INLINE F visibility(const ShadowLook& look, const V3& position, const V3& normal, F radius, Mask lit) {
    const Floats df;
    const Ints di;
    const CameraView& view = look.seen.view;
    const auto* words = reinterpret_cast<const int32_t*>(look.seen.texels);
    const F zero = hn::Zero(df), one = set(1.0f), half = set(0.5f);
    const auto depths = [&](const ShadowTexels& at) {
        return hn::BitCast(df, hn::GatherIndex(di, words, at.first_word));
    };
    const auto radii = [&](const ShadowTexels& at) {
        return texel_radii(hn::BitCast(Words(), hn::GatherIndex(di, words + 3, at.first_word)));
    };
    const V3 offset = moved(position, look.from_view);
    Places place = view_places(view, offset);
    lit = hn::And(lit, hn::Gt(place.depth, zero));
    if (hn::AllFalse(df, lit)) return zero;

    // shadow_lift()
    const ShadowTexels nearest = shadow_texels(view, place.x, place.y, lit);
    F lift = hn::Max(radius, mul(set(1.5f * look.texel_width), place.depth));
    const F beside = radii(nearest), beside_depth = depths(nearest);
    const Mask close = hn::And(hn::Gt(beside_depth, zero),
                               hn::Lt(hn::Abs(sub(beside_depth, place.depth)), mul(set(4.0f), beside)));
    lift = hn::IfThenElse(close, hn::Max(lift, beside), lift);
    lift = mul(lift, set(1 + kRimPush));
    const V3 lifted{add(offset.x, mul(normal.x, lift)), add(offset.y, mul(normal.y, lift)),
                    add(offset.z, mul(normal.z, lift))};

    place = view_places(view, lifted);
    lit = hn::And(lit, hn::Gt(place.depth, zero));
    const F x = sub(place.x, half), y = sub(place.y, half);
    const F low_x = hn::Floor(x), low_y = hn::Floor(y), share_x = sub(x, low_x), share_y = sub(y, low_y);
    F visible = zero;
    for (int i = 0; i < 4; ++i) {
        const bool right = i & 1, below = i >> 1;
        const ShadowTexels at =
            shadow_texels(view, right ? add(low_x, one) : low_x, below ? add(low_y, one) : low_y, lit);
        // texel_blocks()
        const F depth = depths(at), caster_radius = radii(at);
        const V3 facing =
            decode_octahedral(hn::BitCast(Words(), hn::GatherIndex(di, words + 1, at.first_word)));
        const V3 caster = view_offset(view, add(at.column, half), add(at.row, half), depth);
        const V3 apart{sub(lifted.x, caster.x), sub(lifted.y, caster.y), sub(lifted.z, caster.z)};
        const F margin = mul(set(kRimPush), hn::Max(radius, caster_radius));
        Mask blocks =
            hn::And(hn::Gt(depth, zero), hn::Gt(place.depth, sub(depth, mul(set(2.0f), caster_radius))));
        blocks = hn::And(blocks, hn::Lt(dot(facing, apart), margin));
        const F weight = mul(right ? share_x : sub(one, share_x), below ? share_y : sub(one, share_y));
        visible = add(visible, hn::IfThenZeroElse(blocks, weight));
    }
    return hn::IfThenElseZero(lit, visible);
}

}  // namespace lucarne::gi::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
