// How lights shine, light.h, for vectors of directions. Included once for each instruction set (Highway's
// foreach_target.h).
#if defined(LUCARNE_GI_LIGHTING_NATIVE_EMISSION_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LUCARNE_GI_LIGHTING_NATIVE_EMISSION_INL_H
#undef LUCARNE_GI_LIGHTING_NATIVE_EMISSION_INL_H
#else
#define LUCARNE_GI_LIGHTING_NATIVE_EMISSION_INL_H
#endif

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "gi/native/vectors-inl.h"
#include "gi/shared/light.h"

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::native::HWY_NAMESPACE {

/// light_intensity() over light.strength. `cosine` is that between the direction away from the light and the
/// light's.
HWY_INLINE F intensity_share(const Light& light, F cosine) {
    const F one = set(1.0f), zero = hn::Zero(Floats());
    if (light.kind == kPointLight) return one;
    if (light.kind == kCosineLight) return hn::Max(cosine, zero);
    const float outer = light.position.w, width = light.direction.w - outer;
    const F t = width > 0 ? clamped(over(sub(cosine, set(outer)), set(width)))
                          : hn::IfThenElseZero(hn::Ge(cosine, set(outer)), one);
    return mul(mul(t, t), sub(set(3.0f), mul(set(2.0f), t)));
}

/// Whether light_face() of offsets from the light is `face`.
HWY_INLINE Mask goes_through(const Light& light, uint32_t face, const V3& offset) {
    const F zero = hn::Zero(Floats());
    const auto flip = [](Mask mask, bool wanted) { return wanted ? mask : hn::Not(mask); };
    if (light.kind == kPointLight) {
        const F x = hn::Abs(offset.x), y = hn::Abs(offset.y), z = hn::Abs(offset.z);
        const Mask first = hn::And(hn::Ge(x, y), hn::Ge(x, z)), second = hn::AndNot(first, hn::Ge(y, z));
        const Mask third = hn::AndNot(first, hn::Not(second));
        const F along = face < 2 ? offset.x : face < 4 ? offset.y : offset.z;
        return hn::And(face < 2   ? first
                       : face < 4 ? second
                                  : third,
                       flip(hn::Gt(along, zero), face % 2 == 0));
    }
    if (light.kind == kDirectionalLight && light.nested > 1) {
        // nested_view()
        const F along = dot(offset, light.direction);
        const F across2 = sub(dot(offset, offset), mul(along, along));
        const auto within = [&](uint32_t view) {
            float half = light.position.w;
            for (uint32_t i = 0; i < view; ++i) half *= kNestedStep;
            return hn::Le(across2, set(half * half));
        };
        const Mask all = hn::Eq(zero, zero);
        return hn::AndNot(face == 0 ? hn::Not(all) : within(face - 1),
                          face + 1 < light.nested ? within(face) : all);
    }
    const glm::vec3 side(light.extent), other = glm::cross(glm::vec3(light.direction), side);
    if (light.kind != kCosineLight) return hn::Eq(zero, zero);
    return hn::And(flip(hn::Lt(dot(offset, glm::vec4(side, 0)), zero), face & 1),
                   flip(hn::Lt(dot(offset, glm::vec4(other, 0)), zero), face & 2));
}

}  // namespace lucarne::gi::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
