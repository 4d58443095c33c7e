// Vectors of floats and words for passes in C++, on Highway. No operation is fused with another, so that
// every instruction set gives the same bits. Included once for each instruction set (Highway's
// foreach_target.h).
#if defined(LUCARNE_GI_NATIVE_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LUCARNE_GI_NATIVE_VECTORS_INL_H
#undef LUCARNE_GI_NATIVE_VECTORS_INL_H
#else
#define LUCARNE_GI_NATIVE_VECTORS_INL_H
#endif

#include <glm/vec4.hpp>
#include <hwy/highway.h>

#include "gi/shared/surfel_code.h"

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::native::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Words = hn::ScalableTag<uint32_t>;
using Ints = hn::ScalableTag<int32_t>;
using F = hn::Vec<Floats>;
using U = hn::Vec<Words>;
using Mask = hn::Mask<Floats>;

HWY_INLINE F set(float value) {
    return hn::Set(Floats(), value);
}
HWY_INLINE U word(uint32_t value) {
    return hn::Set(Words(), value);
}
HWY_INLINE F add(F a, F b) {
    return hn::Add(a, b);
}
HWY_INLINE F sub(F a, F b) {
    return hn::Sub(a, b);
}
HWY_INLINE F mul(F a, F b) {
    return hn::Mul(a, b);
}
HWY_INLINE F over(F a, F b) {
    return hn::Div(a, b);
}
HWY_INLINE F clamped(F v) {
    return hn::Min(hn::Max(v, hn::Zero(Floats())), set(1.0f));
}
/// Converts words below 2^31.
HWY_INLINE F to_float(U v) {
    return hn::ConvertTo(Floats(), hn::BitCast(Ints(), v));
}

/// Converts numbers to integers, toward zero or to the nearest; NaN becomes 0, because plain C++ has no
/// conversion for it. Lanes that are not used may hold anything.
template <class D>
HWY_INLINE hn::Vec<D> to_int(D di, hn::Vec<hn::RebindToFloat<D>> v) {
    return hn::ConvertTo(di, hn::IfThenElseZero(hn::Eq(v, v), v));
}
HWY_INLINE hn::Vec<Ints> nearest_int(F v) {
    return hn::NearestInt(hn::IfThenElseZero(hn::Eq(v, v), v));
}

struct V3 {
    F x, y, z;
};
HWY_INLINE F dot(const V3& a, const V3& b) {
    return add(add(mul(a.x, b.x), mul(a.y, b.y)), mul(a.z, b.z));
}
HWY_INLINE V3 scaled(const V3& a, F s) {
    return {mul(a.x, s), mul(a.y, s), mul(a.z, s)};
}
HWY_INLINE F dot(const V3& a, const glm::vec4& b) {
    return add(add(mul(a.x, set(b.x)), mul(a.y, set(b.y))), mul(a.z, set(b.z)));
}
HWY_INLINE V3 choose(Mask mask, const V3& yes, const V3& no) {
    return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
            hn::IfThenElse(mask, yes.z, no.z)};
}
HWY_INLINE V3 normalized(const V3& v) {
    return scaled(v, over(set(1.0f), hn::Sqrt(dot(v, v))));
}

/// A fraction of 16 bits with a sign, as unpackSnorm2x16() in GLSL.
HWY_INLINE F snorm(hn::Vec<Ints> v) {
    return hn::Max(over(hn::ConvertTo(Floats(), v), set(32767.0f)), set(-1.0f));
}
HWY_INLINE V3 decode_octahedral(U code) {
    const auto bits = hn::BitCast(Ints(), code);
    F x = snorm(hn::ShiftRight<16>(hn::ShiftLeft<16>(bits))), y = snorm(hn::ShiftRight<16>(bits));
    const F z = sub(sub(set(1.0f), hn::Abs(x)), hn::Abs(y));
    const F t = hn::Max(hn::Neg(z), hn::Zero(Floats()));
    x = add(x, hn::IfThenElse(hn::Ge(x, hn::Zero(Floats())), hn::Neg(t), t));
    y = add(y, hn::IfThenElse(hn::Ge(y, hn::Zero(Floats())), hn::Neg(t), t));
    return normalized({x, y, z});
}
HWY_INLINE U encode_octahedral(const V3& n) {
    const F one = set(1.0f), zero = hn::Zero(Floats());
    const F sum = add(add(hn::Abs(n.x), hn::Abs(n.y)), hn::Abs(n.z));
    const F x = over(n.x, sum), y = over(n.y, sum);
    const auto sign = [&](F v) { return hn::IfThenElse(hn::Ge(v, zero), one, set(-1.0f)); };
    const Mask below = hn::Lt(n.z, zero);
    const auto code = [&](F v) {
        const F clamped = hn::Max(hn::Min(v, one), set(-1.0f));
        return hn::BitCast(Words(), nearest_int(mul(clamped, set(32767.0f))));
    };
    const U u = code(hn::IfThenElse(below, mul(sub(one, hn::Abs(y)), sign(x)), x));
    const U v = code(hn::IfThenElse(below, mul(sub(one, hn::Abs(x)), sign(y)), y));
    return hn::Or(hn::And(u, word(0xffffu)), hn::ShiftLeft<16>(v));
}

/// Returns the halves that packHalf2x16() wrote, for numbers from 0 on.
HWY_INLINE F half_value(U bits) {
    // Moving the bits of a half to those of a float divides it by 2^112; denormal halves become normal
    // floats.
    return mul(hn::BitCast(Floats(), hn::ShiftLeft<13>(hn::And(bits, word(0x7fffu)))), set(0x1p112f));
}

/// Returns the lanes of a mask as bits.
HWY_INLINE uint32_t bits_of(Mask mask) {
    uint8_t bits[8] = {};
    hn::StoreMaskBits(Floats(), mask, bits);
    return bits[0] | uint32_t{bits[1]} << 8;
}

// For rows of pixels or texels: most discs are narrower than eight.
using RowFloats = hn::CappedTag<float, 8>;
using RowWords = hn::RebindToUnsigned<RowFloats>;
using RowInts = hn::RebindToSigned<RowFloats>;
using Row = hn::Vec<RowFloats>;
constexpr int kRowLanes = static_cast<int>(hn::MaxLanes(RowFloats()));

}  // namespace lucarne::gi::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
