// Decodes rows of G-buffer texels. Included once for each instruction set (Highway's foreach_target.h).
#if defined(LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_SURFACES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_SURFACES_INL_H
#undef LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_SURFACES_INL_H
#else
#define LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_SURFACES_INL_H
#endif

#include <algorithm>
#include <cstring>

#include <glm/vec3.hpp>

#include "gi/engines/vpl/shading/native/surfaces.h"
#include "gi/raster/native/vectors-inl.h"
#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace gi::native::HWY_NAMESPACE;

constexpr int kLanes = HWY_MAX_BYTES / 4;
static_assert(kLanes <= kBorder);

/// Decodes a row of texels.
inline void read_row(const CameraView& camera, const GBufferTexel* texels, int y, size_t row, Surfaces& out) {
    const Floats df;
    const bool parallel = camera.projection == kOrthographic;
    const auto width = static_cast<int>(camera.width);
    const float down =
        2 * (static_cast<float>(y) + 0.5f + camera.up.w) / static_cast<float>(camera.height) - 1;
    const glm::vec3 right(camera.right), forward(camera.forward), lowered = down * -glm::vec3(camera.up);
    for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(df))) {
        alignas(64) GBufferTexel lanes[kLanes] = {};
        std::memcpy(
            lanes, texels + static_cast<size_t>(y) * camera.width + static_cast<size_t>(x),
            sizeof(GBufferTexel) * static_cast<size_t>(std::min(static_cast<int>(hn::Lanes(df)), width - x)));
        U depth_bits, normal, albedo, material;
        hn::LoadInterleaved4(Words(), reinterpret_cast<const uint32_t*>(lanes), depth_bits, normal, albedo,
                             material);
        const F depth = hn::BitCast(df, depth_bits);
        const F column = add(hn::Iota(df, static_cast<float>(x)), set(0.5f + camera.right.w));
        const F across = sub(over(mul(set(2.0f), column), set(static_cast<float>(camera.width))), set(1.0f));
        const auto axis = [&](float r, float d, float f) {
            const F offset = add(mul(set(r), across), set(d));
            return parallel ? add(offset, mul(depth, set(f))) : mul(depth, add(set(f), offset));
        };
        const V3 n = decode_octahedral(normal);
        const size_t at = row * out.stride + kBorder + static_cast<size_t>(x);
        hn::StoreU(axis(right.x, lowered.x, forward.x), df, &out.x[at]);
        hn::StoreU(axis(right.y, lowered.y, forward.y), df, &out.y[at]);
        hn::StoreU(axis(right.z, lowered.z, forward.z), df, &out.z[at]);
        hn::StoreU(n.x, df, &out.nx[at]);
        hn::StoreU(n.y, df, &out.ny[at]);
        hn::StoreU(n.z, df, &out.nz[at]);
        hn::StoreU(depth, df, &out.depth[at]);
        hn::StoreU(half_value(hn::ShiftRight<16>(material)), df, &out.radius[at]);
    }
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
