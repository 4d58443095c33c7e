#include <algorithm>

#include "gi/lighting/native/light.h"
#include "io/core/parallel.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/lighting/native/surfel_light.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/lighting/native/shadows-inl.h"

#ifndef LUCARNE_NATIVE_SURFEL_LIGHT_ONCE
#define LUCARNE_NATIVE_SURFEL_LIGHT_ONCE
namespace lucarne::gi::native {

struct SurfelJob {
    const LitSides& lit;
    const Light& light;
    ShadowLook shadows;
};

}  // namespace lucarne::gi::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::native::HWY_NAMESPACE {

/// Surfels in a row, as many as a vector has lanes; lanes from `count` on repeat the last one.
struct SurfelLanes {
    V3 position;
    F radius;
    U normal, albedo;
};
HWY_INLINE SurfelLanes load_surfels(const FlatSurfel* surfels, int count) {
    const Floats df;
    const Ints di;
    constexpr int kWords = sizeof(FlatSurfel) / 4;
    const auto lane = hn::Min(hn::Iota(di, 0), hn::Set(di, count - 1));
    const auto first = hn::Mul(lane, hn::Set(di, kWords));
    const auto* words = reinterpret_cast<const int32_t*>(surfels);
    const auto word_at = [&](int i) { return hn::GatherIndex(di, words + i, first); };
    const auto float_at = [&](int i) { return hn::BitCast(df, word_at(i)); };
    return {{float_at(0), float_at(1), float_at(2)},
            float_at(3),
            hn::BitCast(Words(), word_at(5)),
            hn::BitCast(Words(), word_at(6))};
}

void light_surfels(const SurfelJob& job, size_t begin, int count) {
    const Floats df;
    const F zero = hn::Zero(df);
    const Light& light = job.light;
    const SurfelLanes surfels = load_surfels(job.lit.surfels.data() + begin, count);
    const Mask has_normal =
        hn::RebindMask(df, hn::Ne(hn::And(surfels.albedo, word(kSurfelHasNormal)), word(0)));
    Mask lit = hn::And(hn::Gt(surfels.radius, zero), has_normal);
    const V3 offset = moved(surfels.position, -glm::vec3(light.position));
    lit = hn::And(lit, goes_through(light, job.shadows.seen.face, offset));
    if (hn::AllFalse(df, lit)) return;

    // A sharp light reaches one of the two sides.
    const V3 outward = decode_octahedral(surfels.normal);
    const F front = irradiance_share(light, offset, outward);
    const Mask is_front = hn::Gt(front, zero);
    const auto turned = [&](F v) { return hn::IfThenElse(is_front, v, hn::Neg(v)); };
    const V3 normal{turned(outward.x), turned(outward.y), turned(outward.z)};
    F share = hn::IfThenElse(is_front, front, irradiance_share(light, offset, normal));
    lit = hn::And(lit, hn::Gt(share, zero));
    if (hn::AllFalse(df, lit)) return;
    share = mul(share, visibility(job.shadows, surfels.position, normal, surfels.radius, lit));

    alignas(64) float shares[kLanes], fronts[kLanes], away[3][kLanes];
    hn::Store(hn::IfThenElseZero(lit, share), df, shares);
    hn::Store(hn::IfThenElseZero(is_front, set(1.0f)), df, fronts);
    hn::Store(offset.x, df, away[0]);
    hn::Store(offset.y, df, away[1]);
    hn::Store(offset.z, df, away[2]);
    for (int i = 0; i < count; ++i) {
        if (!(shares[i] > 0)) continue;
        const size_t at = 6 * (begin + static_cast<size_t>(i)) + (fronts[i] > 0 ? 0 : 3);
        const glm::vec3 arriving = shares[i] * glm::vec3(light.strength);
        for (int c = 0; c < 3; ++c) job.lit.irradiance[at + static_cast<size_t>(c)] += arriving[c];
        if (!job.lit.directions) continue;
        const glm::vec3 to_light = light.kind == kDirectionalLight
                                       ? -glm::vec3(light.direction)
                                       : -glm::normalize(glm::vec3(away[0][i], away[1][i], away[2][i]));
        const glm::vec3 toward = to_light * ((arriving.x + arriving.y + arriving.z) / 3);
        for (int c = 0; c < 3; ++c) job.lit.directions[at + static_cast<size_t>(c)] += toward[c];
    }
}

void SurfelRange(const SurfelJob& job, size_t first, size_t end) {
    const size_t lanes = hn::Lanes(Floats());
    for (size_t i = first; i < end; i += lanes)
        light_surfels(job, i, static_cast<int>(HWY_MIN(lanes, end - i)));
}

}  // namespace lucarne::gi::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::native {

HWY_EXPORT(SurfelRange);
void add_surfel_light(const LitSides& lit, const Light& light, const LightShadows& shadows) {
    const SurfelJob job{lit, light, ShadowLook(shadows, glm::vec3(0.0f))};
    parallel_ranges(lit.surfels.size(), 4096, [&](size_t first, size_t end) {
        HWY_DYNAMIC_DISPATCH(SurfelRange)(job, first, end);
    });
}

}  // namespace lucarne::gi::native
#endif
