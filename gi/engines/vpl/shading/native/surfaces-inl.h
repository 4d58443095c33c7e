// Decodes rows of G-buffer texels. Included once for each instruction set (Highway's foreach_target.h).
#if defined(LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_SURFACES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_SURFACES_INL_H
#undef LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_SURFACES_INL_H
#else
#define LUCARNE_GI_ENGINES_VPL_SHADING_NATIVE_SURFACES_INL_H
#endif

#include "gi/engines/vpl/shading/native/surfaces.h"
#include "gi/native/texels-inl.h"
#include "gi/shared/camera.h"
#include "gi/shared/gbuffer.h"

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace gi::native::HWY_NAMESPACE;

static_assert(kLanes <= kBorder);

/// Decodes a row of texels.
inline void read_row(const CameraView& camera, const GBufferTexel* texels, int y, size_t row, Surfaces& out) {
    const Floats df;
    const auto width = static_cast<int>(camera.width);
    for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(df))) {
        const TexelWords words =
            load_texels(texels + static_cast<size_t>(y) * camera.width + static_cast<size_t>(x), width - x);
        const F depth = hn::BitCast(df, words.depth);
        const V3 position = view_offset(camera, view_columns(camera, x), view_row(camera, y), depth);
        const V3 n = decode_octahedral(words.normal);
        const size_t at = row * out.stride + kBorder + static_cast<size_t>(x);
        hn::StoreU(position.x, df, &out.x[at]);
        hn::StoreU(position.y, df, &out.y[at]);
        hn::StoreU(position.z, df, &out.z[at]);
        hn::StoreU(n.x, df, &out.nx[at]);
        hn::StoreU(n.y, df, &out.ny[at]);
        hn::StoreU(n.z, df, &out.nz[at]);
        hn::StoreU(depth, df, &out.depth[at]);
        hn::StoreU(texel_radii(words.material), df, &out.radius[at]);
    }
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
