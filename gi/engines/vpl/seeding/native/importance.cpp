#include "gi/engines/vpl/seeding/native/importance.h"

#include <algorithm>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "gi/native/reflectance.h"
#include "gi/shared/luminance.h"
#include "io/core/parallel.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/engines/vpl/seeding/native/importance.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/lighting/native/emission-inl.h"
#include "gi/native/texels-inl.h"

#ifndef LUCARNE_NATIVE_IMPORTANCE_ONCE
#define LUCARNE_NATIVE_IMPORTANCE_ONCE
namespace lucarne::gi::vpl::native {

struct ImportanceJob {
    const ImportanceInput& input;
    gi::native::DiffuseTables tables;
    float strength;    ///< luminance of the light's
    float pixel_area;  ///< of the view at a depth of 1
};

}  // namespace lucarne::gi::vpl::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace gi::native::HWY_NAMESPACE;

/// The mean of view_intensity() over corners and centre of the texels from (x, y) on, over the strength.
inline F mean_intensity(const ImportanceJob& job, int x, int y, F depth) {
    const Light& light = job.input.light;
    const CameraView& view = job.input.view;
    const F first = add(hn::Iota(Floats(), static_cast<float>(x)), set(view.right.w));
    const F row = set(static_cast<float>(y) + view.up.w);
    F sum = hn::Zero(Floats());
    for (int i = 0; i < 5; ++i) {
        const float dx = i == 4 ? 0.5f : static_cast<float>(i & 1);
        const float dy = i == 4 ? 0.5f : static_cast<float>(i >> 1);
        const V3 ray = view_ray(view, add(first, set(dx)), add(row, set(dy)));
        const F length2 = dot(ray, ray);
        F share = mul(mul(depth, depth), length2);
        if (light.kind == kDirectionalLight) {
            const glm::vec3 from = glm::vec3(view.origin) - glm::vec3(light.position);
            const V3 offset{add(mul(ray.x, depth), set(from.x)), add(mul(ray.y, depth), set(from.y)),
                            add(mul(ray.z, depth), set(from.z))};
            share = hn::IfThenElseZero(goes_through(light, job.input.face, offset), share);
        } else {
            const F cosine = over(dot(ray, light.direction), hn::Sqrt(length2));
            share =
                hn::IfThenElseZero(goes_through(light, job.input.face, ray), intensity_share(light, cosine));
        }
        sum = add(sum, mul(set(0.2f), share));
    }
    return sum;
}

/// Writes a row of level 0.
inline void importance_row(const ImportanceJob& job, int y, glm::vec2* row) {
    const Floats df;
    const ImportanceInput& input = job.input;
    const auto width = static_cast<int>(input.view.width), side = static_cast<int>(input.side);
    const int filled = y < static_cast<int>(input.view.height) ? width : 0;
    const F zero = hn::Zero(df), one = set(1.0f);
    for (int x = 0; x < filled; x += static_cast<int>(hn::Lanes(df))) {
        const size_t at = static_cast<size_t>(y) * input.view.width + static_cast<size_t>(x);
        const TexelWords texel = load_texels(input.texels + at, width - x);
        const F depth = hn::BitCast(df, texel.depth);
        const F intensity = mul(mean_intensity(job, x, y, depth), set(job.strength));
        const Mask lit = hn::And(hn::Gt(depth, zero), hn::Gt(intensity, zero));
        const V3 middle = view_ray(input.view, view_columns(input.view, x), view_row(input.view, y));
        const F cosine = over(one, hn::Sqrt(dot(middle, middle)));
        const F solid_angle = mul(set(job.pixel_area), mul(mul(cosine, cosine), cosine));
        const V3 kd = diffuse_reflectance(job.tables, texel.albedo, texel.material);
        const F reflected = dot(kd, glm::vec4(kRedWeight, kGreenWeight, kBlueWeight, 0));
        const F weight = hn::IfThenElseZero(lit, mul(mul(intensity, solid_angle), reflected));
        alignas(64) float lanes[2 * kLanes];
        hn::StoreInterleaved2(weight, hn::IfThenElseZero(lit, one), df, lanes);
        const auto count = static_cast<size_t>(HWY_MIN(width - x, static_cast<int>(hn::Lanes(df))));
        std::memcpy(row + x, lanes, count * sizeof(glm::vec2));
    }
    std::fill(row + filled, row + side, glm::vec2(0.0f));
}

void ImportanceRows(const ImportanceJob& job, int first, int end, glm::vec2* level) {
    for (int y = first; y < end; ++y) importance_row(job, y, level + static_cast<size_t>(y) * job.input.side);
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::vpl::native {
namespace {

/// Sums 2 x 2 texels of the level below.
void sum_level(const glm::vec2* below, uint32_t side, glm::vec2* level) {
    parallel_ranges(side, 64, [&](size_t first, size_t end) {
        for (size_t y = first; y < end; ++y) {
            const glm::vec2* upper = below + 2 * y * 2 * side;
            const glm::vec2* lower = upper + 2 * side;
            for (size_t x = 0; x < side; ++x)
                level[y * side + x] = (upper[2 * x] + upper[2 * x + 1]) + (lower[2 * x] + lower[2 * x + 1]);
        }
    });
}

}  // namespace

HWY_EXPORT(ImportanceRows);
void map_importance(const ImportanceInput& input, std::span<glm::vec2> levels) {
    const CameraView& view = input.view;
    const float pixels = static_cast<float>(view.width) * static_cast<float>(view.height);
    const ImportanceJob job{
        input, gi::native::DiffuseTables(input.materials), luminance(glm::vec3(input.light.strength)),
        4 * glm::length(glm::vec3(view.right)) * glm::length(glm::vec3(view.up)) / pixels};
    parallel_ranges(input.side, 32, [&](size_t first, size_t end) {
        HWY_DYNAMIC_DISPATCH(ImportanceRows)
        (job, static_cast<int>(first), static_cast<int>(end), levels.data());
    });
    glm::vec2* below = levels.data();
    for (uint32_t side = input.side; side > 1; side /= 2) {
        glm::vec2* level = below + size_t{side} * side;
        sum_level(below, side / 2, level);
        below = level;
    }
}

}  // namespace lucarne::gi::vpl::native
#endif
