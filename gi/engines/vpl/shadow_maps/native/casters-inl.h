// The casters of a block (casters.glsl) for vectors, and the codes of their surfaces (texel.h). Included once
// for each instruction set (Highway's foreach_target.h).
#if defined(LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_NATIVE_CASTERS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_NATIVE_CASTERS_INL_H
#undef LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_NATIVE_CASTERS_INL_H
#else
#define LUCARNE_GI_ENGINES_VPL_SHADOW_MAPS_NATIVE_CASTERS_INL_H
#endif

#include "gi/engines/vpl/shadow_maps/native/casters.h"
#include "gi/engines/vpl/shadow_maps/queue.h"
#include "gi/engines/vpl/shadow_maps/texel.h"
#include "gi/native/vectors-inl.h"
#include "gi/shared/surfel.h"

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace gi::native::HWY_NAMESPACE;

constexpr size_t kLanes = HWY_MAX_BYTES / 4;

/// Casters of a block, one after the other.
struct Casters {
    static constexpr size_t kRoom = kBlockSurfels + kLanes;
    alignas(64) float x[kRoom], y[kRoom], z[kRoom], nx[kRoom], ny[kRoom], nz[kRoom];
    alignas(64) float radius[kRoom], scale[kRoom];
    alignas(64) uint32_t id[kRoom];
};

/// Decodes the casters of a block; `codes` are those of all blocks.
inline void decode_casters(const uint32_t* codes, const CasterTables& tables, uint32_t block,
                           Casters& casters) {
    const Floats df;
    const Words du;
    const Ints di;
    codes += size_t{block} * kBlockSurfels * kCasterWords;
    for (uint32_t i = 0; i < kBlockSurfels; i += static_cast<uint32_t>(hn::Lanes(df))) {
        U x, y, z, code;
        hn::LoadInterleaved4(du, codes + size_t{i} * kCasterWords, x, y, z, code);
        const auto radius = hn::And(hn::ShiftRight<18>(code), word(127));
        const F none = hn::Zero(df);
        const Mask drawn = hn::RebindMask(df, hn::Ne(radius, word(0)));
        const Mask turned = hn::RebindMask(df, hn::Ne(hn::And(code, word(0x3ffffu)), word(0)));
        const auto fraction = [&](U bits) {
            const F p = over(sub(to_float(hn::And(bits, word(511))), set(256.0f)), set(255.0f));
            const F inside = hn::Max(hn::Min(p, set(1.0f)), set(-1.0f));
            return hn::BitCast(du, nearest_int(mul(inside, set(32767.0f))));
        };
        const U octahedral = hn::Or(hn::And(fraction(code), word(0xffffu)),
                                    hn::ShiftLeft<16>(fraction(hn::ShiftRight<9>(code))));
        const V3 normal = choose(turned, decode_octahedral(octahedral), {none, none, none});
        const F scale = hn::GatherIndex(df, tables.scales.data(), hn::BitCast(di, hn::ShiftRight<25>(code)));
        hn::Store(hn::BitCast(df, x), df, casters.x + i);
        hn::Store(hn::BitCast(df, y), df, casters.y + i);
        hn::Store(hn::BitCast(df, z), df, casters.z + i);
        hn::Store(normal.x, df, casters.nx + i);
        hn::Store(normal.y, df, casters.ny + i);
        hn::Store(normal.z, df, casters.nz + i);
        hn::Store(hn::GatherIndex(df, tables.radii.data(), hn::BitCast(di, radius)), df, casters.radius + i);
        hn::Store(hn::IfThenElse(drawn, scale, set(-1.0f)), df, casters.scale + i);
        hn::Store(hn::Iota(du, block * kBlockSurfels + i), du, casters.id + i);
    }
}

/// map_surface() of texel.h.
HWY_INLINE U map_surface(F radius, const V3& normal) {
    const Ints di;
    // floor(log2(radius) + 11.5) is the exponent of radius * sqrt(2), plus 11.
    const auto exponent =
        hn::Sub(hn::BitCast(di, hn::ShiftRight<23>(hn::BitCast(Words(), mul(radius, set(1.41421356f))))),
                hn::Set(di, static_cast<int32_t>(kRadiusBias)));
    const auto code = hn::Min(hn::Max(exponent, hn::Zero(di)), hn::Set(di, 15));
    const U bits = encode_octahedral(normal);
    const auto steps = [&](hn::Vec<Ints> fraction) {
        return hn::BitCast(Words(), to_int(di, add(mul(snorm(fraction), set(31.5f)), set(31.999f))));
    };
    const auto both = hn::BitCast(di, bits);
    const U u = steps(hn::ShiftRight<16>(hn::ShiftLeft<16>(both))), v = steps(hn::ShiftRight<16>(both));
    return hn::Or(hn::Or(hn::ShiftLeft<12>(hn::BitCast(Words(), code)), hn::ShiftLeft<6>(v)), u);
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
