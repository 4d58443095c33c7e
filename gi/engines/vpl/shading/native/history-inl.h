// history.glsl for vectors of pixels. Included once for each instruction set (Highway's foreach_target.h).
#if defined(LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_HISTORY_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_HISTORY_INL_H
#undef LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_HISTORY_INL_H
#else
#define LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_HISTORY_INL_H
#endif

#include "gi/engines/vpl/shading/merging.h"
#include "gi/engines/vpl/shading/native/merge.h"
#include "gi/native/texels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace gi::native::HWY_NAMESPACE;

/// The average light of a point, W/m^2, and the number of frames in it.
struct KnownLight {
    V3 irradiance;
    F frames;
};

/// last_known(): the light of points in the last frame, 0 frames where it did not see them and in lanes that
/// are not `shown`. `position` is relative to the origin of the last camera.
HWY_INLINE KnownLight last_known(const MergeHistory& history, const V3& position, const V3& normal,
                                 Mask shown) {
    const Floats df;
    const Ints di;
    const CameraView& view = *history.last_camera;
    const F zero = hn::Zero(df), one = set(1.0f), half = set(0.5f),
            width = set(static_cast<float>(view.width)), height = set(static_cast<float>(view.height));
    KnownLight sum{{zero, zero, zero}, zero};
    const Places place = view_places(view, position);
    const auto within = [&](F v, F size) { return hn::And(hn::Gt(v, zero), hn::Lt(v, size)); };
    Mask seen = hn::And(hn::And(shown, hn::Gt(place.depth, zero)),
                        hn::And(within(place.x, width), within(place.y, height)));
    if (hn::AllFalse(df, seen)) return sum;
    const F pixel_width = mul(set(kSamePlane), pixel_heights(view, place.depth));
    const F at_x = sub(place.x, half), at_y = sub(place.y, half);
    const F corner_x = hn::Floor(at_x), corner_y = hn::Floor(at_y);
    const F share_x = sub(at_x, corner_x), share_y = sub(at_y, corner_y);
    const auto* surfaces = reinterpret_cast<const int32_t*>(history.last_surfaces);
    const auto* light = reinterpret_cast<const float*>(history.last_light);
    F weights = zero;
    for (int i = 0; i < 4; ++i) {
        const bool right = i & 1, below = i >> 1;
        const F column = right ? add(corner_x, one) : corner_x, row = below ? add(corner_y, one) : corner_y;
        const Mask inside = hn::And(hn::And(hn::Ge(column, zero), hn::Lt(column, width)),
                                    hn::And(hn::Ge(row, zero), hn::Lt(row, height)));
        const auto pixel = [&](F v) { return to_int(di, hn::IfThenElseZero(hn::And(seen, inside), v)); };
        const auto index =
            hn::Add(hn::Mul(pixel(row), hn::Set(di, static_cast<int32_t>(view.width))), pixel(column));
        const auto pair = hn::ShiftLeft<1>(index);
        const F depth = hn::BitCast(df, hn::GatherIndex(di, surfaces, pair));
        const U code = hn::BitCast(Words(), hn::GatherIndex(di, surfaces + 1, pair));
        const V3 there =
            view_offset(view, add(column, set(0.5f + view.right.w)), add(row, set(0.5f + view.up.w)), depth);
        const V3 apart{sub(there.x, position.x), sub(there.y, position.y), sub(there.z, position.z)};
        Mask same = hn::And(hn::And(seen, inside), hn::Gt(depth, zero));
        same = hn::And(same, hn::Lt(hn::Abs(dot(normal, apart)), pixel_width));
        same = hn::And(same, hn::Gt(dot(decode_octahedral(code), normal), set(kSameNormal)));
        if (hn::AllFalse(df, same)) continue;
        const F weight = hn::IfThenElseZero(
            same, mul(right ? share_x : sub(one, share_x), below ? share_y : sub(one, share_y)));
        const auto texel = hn::ShiftLeft<2>(index);
        const auto add_channel = [&](F& to, int channel) {
            const F value = hn::GatherIndex(df, light + channel, texel);
            to = add(to, hn::IfThenElseZero(same, mul(weight, value)));
        };
        add_channel(sum.irradiance.x, 0);
        add_channel(sum.irradiance.y, 1);
        add_channel(sum.irradiance.z, 2);
        add_channel(sum.frames, 3);
        weights = add(weights, weight);
    }
    seen = hn::Gt(weights, set(kLeastEvidence));
    const F share = hn::IfThenElseZero(seen, over(one, weights));
    return {scaled(sum.irradiance, share), mul(sum.frames, share)};
}

/// with_history() without storing: averages the irradiance of this frame with that of the last one.
HWY_INLINE KnownLight with_history(const MergeHistory& history, const CameraView& camera, const V3& position,
                                   const V3& normal, Mask shown, const V3& irradiance) {
    const Floats df;
    const F one = set(1.0f);
    if (!history.last_camera) return {irradiance, one};
    const glm::vec4 moved = camera.origin - history.last_camera->origin;
    const V3 from_last{add(position.x, set(moved.x)), add(position.y, set(moved.y)),
                       add(position.z, set(moved.z))};
    const KnownLight known = last_known(history, from_last, normal, shown);
    const Mask any = hn::Gt(known.frames, hn::Zero(df));
    const F frames = hn::IfThenElse(any, add(hn::Min(known.frames, set(history.most_frames - 1)), one), one);
    const auto average = [&](F last, F now) {
        return hn::IfThenElse(any, add(last, over(sub(now, last), frames)), now);
    };
    return {{average(known.irradiance.x, irradiance.x), average(known.irradiance.y, irradiance.y),
             average(known.irradiance.z, irradiance.z)},
            frames};
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
