#include "gi/lighting/native/light.h"

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "gi/native/reflectance.h"
#include "io/core/parallel.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/lighting/native/light.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/lighting/native/shadows-inl.h"
#include "gi/native/texels-inl.h"

#ifndef LUCARNE_NATIVE_LIGHT_ONCE
#define LUCARNE_NATIVE_LIGHT_ONCE
namespace lucarne::gi::native {

struct LightJob {
    const LitPicture& picture;
    const Light& light;
    ShadowLook shadows;
    glm::vec3 from_camera;  ///< from the light to the camera, m
    DiffuseTables tables;
};

}  // namespace lucarne::gi::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::native::HWY_NAMESPACE {

void light_row(const LightJob& job, int y) {
    const Floats df;
    const LitPicture& picture = job.picture;
    const CameraView& camera = picture.camera;
    const auto width = static_cast<int>(camera.width);
    const F zero = hn::Zero(df);
    for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(df))) {
        const int count = width - x;
        const size_t pixel = static_cast<size_t>(y) * camera.width + static_cast<size_t>(x);
        const TexelWords texel = load_texels(picture.texels + pixel, count);
        const F depth = hn::BitCast(df, texel.depth);
        Mask lit = hn::Gt(depth, zero);
        if (hn::AllFalse(df, lit)) continue;
        const V3 position = view_offset(camera, view_columns(camera, x), view_row(camera, y), depth);
        const V3 normal = decode_octahedral(texel.normal);
        const V3 offset = moved(position, job.from_camera);
        F share = irradiance_share(job.light, offset, normal);
        lit = hn::And(hn::And(lit, hn::Gt(share, zero)),
                      goes_through(job.light, job.shadows.seen.face, offset));
        // brdf() is 0 behind the surface.
        const F facing =
            camera.projection == kOrthographic ? dot(normal, camera.forward) : dot(normal, position);
        lit = hn::And(lit, hn::Lt(facing, zero));
        if (hn::AllFalse(df, lit)) continue;
        share = mul(share, visibility(job.shadows, position, normal, texel_radii(texel.material), lit));
        share = mul(share, set(1 / kPi));
        const V3 kd = diffuse_reflectance(job.tables, texel.albedo, texel.material);
        V3 light;
        F w;
        load_vec4(picture.radiance + pixel, count, light, w);
        const auto channel = [&](F before, F reflectance, float strength) {
            const F reflected = mul(mul(share, set(strength)), reflectance);
            return add(before, hn::IfThenElseZero(lit, reflected));
        };
        light = {channel(light.x, kd.x, job.light.strength.x), channel(light.y, kd.y, job.light.strength.y),
                 channel(light.z, kd.z, job.light.strength.z)};
        store_vec4(light, w, count, picture.radiance + pixel);
    }
}

void LightRows(const LightJob& job, int first, int end) {
    for (int y = first; y < end; ++y) light_row(job, y);
}

}  // namespace lucarne::gi::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::native {

HWY_EXPORT(LightRows);
void add_light(const LitPicture& picture, const Light& light, const LightShadows& shadows) {
    const glm::vec3 eye(picture.camera.origin);
    const LightJob job{picture, light, ShadowLook(shadows, eye), eye - glm::vec3(light.position),
                       DiffuseTables(picture.materials)};
    parallel_ranges(picture.camera.height, 16, [&](size_t first, size_t end) {
        HWY_DYNAMIC_DISPATCH(LightRows)(job, static_cast<int>(first), static_cast<int>(end));
    });
}

}  // namespace lucarne::gi::native
#endif
