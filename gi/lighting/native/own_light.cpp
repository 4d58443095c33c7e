#include <algorithm>

#include "gi/lighting/native/light.h"
#include "io/core/parallel.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/lighting/native/own_light.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/native/texels-inl.h"

#ifndef LUCARNE_NATIVE_OWN_LIGHT_ONCE
#define LUCARNE_NATIVE_OWN_LIGHT_ONCE
namespace lucarne::gi::native {

struct OwnLightJob {
    const LitPicture& picture;
    const SkyPicture& sky;
    bool add;
    bool emits;  ///< whether any material does
};

}  // namespace lucarne::gi::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::native::HWY_NAMESPACE {

/// Returns the angle of (x, y), -pi to pi, off by 1e-6 at most: a polynomial between 0 and 45 degrees
/// (Abramowitz & Stegun 1964, 4.4.49).
HWY_INLINE F angle_of(F y, F x) {
    constexpr float kCoefficients[] = {0.0028662257f,  -0.0161657367f, 0.0429096138f,
                                       -0.0752896400f, 0.1065626393f,  -0.1420889944f,
                                       0.1999355085f,  -0.3333314528f, 1.0f};
    const F zero = hn::Zero(Floats()), width = hn::Abs(x), height = hn::Abs(y);
    const F most = hn::Max(width, height);
    const F tangent = hn::IfThenElseZero(hn::Gt(most, zero), over(hn::Min(width, height), most));
    const F square = mul(tangent, tangent);
    F sum = zero;
    for (const float coefficient : kCoefficients) sum = add(mul(sum, square), set(coefficient));
    F angle = mul(sum, tangent);
    angle = hn::IfThenElse(hn::Gt(height, width), sub(set(kPi / 2), angle), angle);
    angle = hn::IfThenElse(hn::Lt(x, zero), sub(set(kPi), angle), angle);
    return hn::IfThenElse(hn::Lt(y, zero), hn::Neg(angle), angle);
}

/// The background along rays, environment_place() in environment.h.
HWY_INLINE V3 background(const SkyPicture& sky, const V3& ray) {
    const Floats df;
    const Ints di;
    const F half = set(0.5f), turn = set(2 * kPi);
    const F turns = add(half, over(add(angle_of(ray.x, ray.y), set(sky.rotation)), turn));
    const F level = hn::Sqrt(add(mul(ray.x, ray.x), mul(ray.y, ray.y)));
    const auto texel = [&](F place, uint32_t size) {
        const auto last = static_cast<float>(size - 1);
        return to_int(di,
                      hn::Min(hn::Max(mul(place, set(static_cast<float>(size))), hn::Zero(df)), set(last)));
    };
    const auto column = texel(sub(turns, hn::Floor(turns)), sky.width),
               row = texel(over(angle_of(level, ray.z), set(kPi)), sky.height);
    const auto index =
        hn::Mul(hn::Add(hn::Mul(row, hn::Set(di, static_cast<int32_t>(sky.width))), column), hn::Set(di, 3));
    return {hn::GatherIndex(df, sky.texels, index), hn::GatherIndex(df, sky.texels + 1, index),
            hn::GatherIndex(df, sky.texels + 2, index)};
}

void own_light_row(const OwnLightJob& job, int y) {
    const Floats df;
    const LitPicture& picture = job.picture;
    const CameraView& camera = picture.camera;
    const auto width = static_cast<int>(camera.width);
    const F zero = hn::Zero(df), one = set(1.0f);
    const auto* emission = &picture.materials.front().emission.x;
    constexpr int kMaterialFloats = sizeof(Material) / sizeof(float);
    for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(df))) {
        const int count = width - x;
        const size_t pixel = static_cast<size_t>(y) * camera.width + static_cast<size_t>(x);
        const TexelWords texel = load_texels(picture.texels + pixel, count);
        const Mask shown = hn::Gt(hn::BitCast(df, texel.depth), zero);
        V3 light{zero, zero, zero};
        if (job.emits) {
            const auto index = hn::Mul(texel_materials(texel.material), hn::Set(Ints(), kMaterialFloats));
            light = {hn::GatherIndex(df, emission, index), hn::GatherIndex(df, emission + 1, index),
                     hn::GatherIndex(df, emission + 2, index)};
        }
        if (!hn::AllTrue(df, shown)) {
            V3 behind{set(job.sky.texels[0]), set(job.sky.texels[1]), set(job.sky.texels[2])};
            if (job.sky.width * job.sky.height > 1)
                behind = background(job.sky, view_ray(camera, view_columns(camera, x), view_row(camera, y)));
            light = choose(shown, light, behind);
        }
        if (job.add) {
            V3 before;
            F unused;
            load_vec4(picture.radiance + pixel, count, before, unused);
            light = {add(light.x, before.x), add(light.y, before.y), add(light.z, before.z)};
        }
        store_vec4(light, one, count, picture.radiance + pixel);
    }
}

void OwnLightRows(const OwnLightJob& job, int first, int end) {
    for (int y = first; y < end; ++y) own_light_row(job, y);
}

}  // namespace lucarne::gi::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::native {

HWY_EXPORT(OwnLightRows);
void add_own_light(const LitPicture& picture, const SkyPicture& sky, bool add) {
    const bool emits = std::ranges::any_of(picture.materials, [](const Material& material) {
        return material.emission.x != 0 || material.emission.y != 0 || material.emission.z != 0;
    });
    const OwnLightJob job{picture, sky, add, emits};
    parallel_ranges(picture.camera.height, 16, [&](size_t first, size_t end) {
        HWY_DYNAMIC_DISPATCH(OwnLightRows)(job, static_cast<int>(first), static_cast<int>(end));
    });
}

}  // namespace lucarne::gi::native
#endif
