// The codec of texel.h for vectors. Included once for each instruction set (Highway's foreach_target.h).
#if defined(LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_NATIVE_TEXEL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_NATIVE_TEXEL_INL_H
#undef LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_NATIVE_TEXEL_INL_H
#else
#define LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_NATIVE_TEXEL_INL_H
#endif

#include <hwy/highway.h>

#include "gi/engines/vpl/shadow_maps/texel.h"

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// D: a tag of words.
template <class D>
using FloatsOf = hn::Vec<hn::RebindToFloat<D>>;

template <class D>
HWY_INLINE FloatsOf<D> map_distances(D d, hn::Vec<D> texels) {
    const auto steps = hn::Add(hn::ShiftRight<16>(texels), hn::Set(d, kDistanceBias));
    return hn::BitCast(hn::RebindToFloat<D>(), hn::Or(hn::ShiftLeft<12>(steps), hn::Set(d, kHalfStep)));
}
template <class D>
HWY_INLINE FloatsOf<D> map_radii(D d, hn::Vec<D> texels) {
    const auto exponent =
        hn::Add(hn::And(hn::ShiftRight<12>(texels), hn::Set(d, 15)), hn::Set(d, kRadiusBias));
    return hn::BitCast(hn::RebindToFloat<D>(), hn::ShiftLeft<23>(exponent));
}
/// Limits distances to those that texels can hold.
template <class D>
HWY_INLINE FloatsOf<D> distances_within(D, FloatsOf<D> distances) {
    const hn::RebindToFloat<D> df;
    return hn::Min(hn::Max(distances, hn::Set(df, kNearestDistance)), hn::Set(df, kFarthestDistance));
}
/// `distances`: limited.
template <class D>
HWY_INLINE hn::Vec<D> pack_map_texels(D d, FloatsOf<D> distances, hn::Vec<D> surfaces) {
    const auto steps = hn::Sub(hn::ShiftRight<12>(hn::BitCast(d, distances)), hn::Set(d, kDistanceBias));
    return hn::Or(hn::ShiftLeft<16>(steps), surfaces);
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
