#include "gi/engines/paths/native/grid_light.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "gi/shared/brdf.h"
#include "io/core/parallel.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/engines/paths/native/grid_light.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/native/texels-inl.h"

#ifndef LUCARNE_NATIVE_GRID_LIGHT_ONCE
#define LUCARNE_NATIVE_GRID_LIGHT_ONCE
namespace lucarne::gi::paths::native {

/// Pixels between four places of the grid: they share these, so that vectors are filled by several short
/// rows.
struct Square {
    static constexpr size_t kMost = size_t{kMostStep} * kMostStep, kRoom = kMost + 16;
    std::array<GBufferTexel, kRoom> texels;
    std::array<float, kRoom> column, row;  ///< of the picture
    std::array<float, kRoom> u, v;         ///< from the first place to the next, 0 to 1
    std::array<uint32_t, kMost> pixels;
    int count = 0;
    const GridLight* places[4];  ///< null: outside of the picture
};

/// Light that a square's pixels reflect.
struct SquareLight {
    std::array<float, Square::kRoom> r, g, b, weights;
};

}  // namespace lucarne::gi::paths::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::paths::native::HWY_NAMESPACE {
using namespace gi::native::HWY_NAMESPACE;

/// Lights the pixels of a square, as upsample() does; weights below kLeastUpsampleWeight say that nothing
/// counts or too little does, negative ones that there is no surface.
void LightSquare(const GridLitPicture& picture, const Square& square, SquareLight& light) {
    const Floats df;
    const CameraView& camera = picture.camera;
    const F zero = hn::Zero(df), one = set(1.0f);
    const auto step = static_cast<float>(picture.grid.step);
    for (int i = 0; i < square.count; i += static_cast<int>(hn::Lanes(df))) {
        const TexelWords texel = load_texels(square.texels.data() + i, kLanes);
        const F depth = hn::BitCast(df, texel.depth);
        const Mask shown = hn::Gt(depth, zero);
        const V3 offset = view_offset(camera, hn::LoadU(df, square.column.data() + i),
                                      hn::LoadU(df, square.row.data() + i), depth);
        const V3 normal = decode_octahedral(texel.normal);
        const F radius = hn::Min(hn::Max(texel_radii(texel.material), set(1e-7f)), set(65504.0f));
        const F reach = add(mul(set(step), pixel_heights(camera, hn::Sqrt(dot(offset, offset)))), radius);
        const F u = hn::LoadU(df, square.u.data() + i), v = hn::LoadU(df, square.v.data() + i);
        V3 sum{zero, zero, zero};
        F weights = zero, matching = zero, best = zero;
        for (int k = 0; k < 4; ++k) {
            const GridLight* place = square.places[k];
            if (!place || !(place->shown > 0)) continue;
            const V3 there{set(place->offset.x), set(place->offset.y), set(place->offset.z)};
            const V3 facing{set(place->normal.x), set(place->normal.y), set(place->normal.z)};
            const F share = mul(k & 1 ? u : sub(one, u), k >> 1 ? v : sub(one, v));
            const F cosine = hn::Max(dot(normal, facing), zero);
            const V3 apart{sub(there.x, offset.x), sub(there.y, offset.y), sub(there.z, offset.z)};
            const F near = hn::Max(sub(one, over(hn::Abs(dot(normal, apart)), reach)), zero);
            const F cosine2 = mul(cosine, cosine), cosine4 = mul(cosine2, cosine2);
            const F cosine8 = mul(cosine4, cosine4), cosine16 = mul(cosine8, cosine8);
            const F match = mul(cosine16, near);
            const F weight = mul(add(share, set(kLeastUpsampleShare)), match);
            matching = add(matching, mul(share, match));
            best = hn::Max(best, match);
            sum = {add(sum.x, mul(weight, set(place->irradiance.x))),
                   add(sum.y, mul(weight, set(place->irradiance.y))),
                   add(sum.z, mul(weight, set(place->irradiance.z)))};
            weights = add(weights, weight);
        }
        const V3 kd = diffuse_reflectance(picture.reflectances, texel.albedo, texel.material);
        const F per_weight = over(set(1 / kPi), hn::Max(weights, set(kLeastUpsampleWeight)));
        hn::StoreU(mul(mul(sum.x, kd.x), per_weight), df, light.r.data() + i);
        hn::StoreU(mul(mul(sum.y, kd.y), per_weight), df, light.g.data() + i);
        hn::StoreU(mul(mul(sum.z, kd.z), per_weight), df, light.b.data() + i);
        const F counting = hn::IfThenZeroElse(hn::Lt(matching, mul(set(picture.least_share), best)), weights);
        hn::StoreU(hn::IfThenElse(shown, counting, set(-1.0f)), df, light.weights.data() + i);
    }
}

}  // namespace lucarne::gi::paths::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::paths::native {

HWY_EXPORT(LightSquare);

namespace {

/// Collects the pixels between the grid's columns `column` and rows `row` and those after them.
void collect(const GridLitPicture& picture, int column, int row, Square& square) {
    const GatherGrid& grid = picture.grid;
    const auto step = static_cast<int>(grid.step), width = static_cast<int>(grid.width),
               height = static_cast<int>(grid.height);
    const int left = static_cast<int>(grid.x) + column * step, upper = static_cast<int>(grid.y) + row * step;
    const int first = std::max(left, 0), end = std::min(left + step, width);
    square.count = 0;
    for (int y = std::max(upper, 0); y < std::min(upper + step, height); ++y)
        for (int x = first; x < end; ++x) {
            const auto i = static_cast<size_t>(square.count++);
            const auto pixel = static_cast<uint32_t>(y * width + x);
            square.pixels[i] = pixel;
            square.texels[i] = picture.texels[pixel];
            square.column[i] = static_cast<float>(x) + 0.5f + picture.camera.right.w;
            square.row[i] = static_cast<float>(y) + 0.5f + picture.camera.up.w;
            square.u[i] = static_cast<float>(x - left) / static_cast<float>(step);
            square.v[i] = static_cast<float>(y - upper) / static_cast<float>(step);
        }
    const auto columns = static_cast<int>(grid.columns()), rows = static_cast<int>(grid.rows());
    for (int k = 0; k < 4; ++k) {
        const int c = column + (k & 1), r = row + (k >> 1);
        const bool inside = c >= 0 && r >= 0 && c < columns && r < rows;
        square.places[k] = inside ? &picture.lights[static_cast<size_t>(r * columns + c)] : nullptr;
    }
}

}  // namespace

std::vector<uint32_t> add_grid_light(const GridLitPicture& picture) {
    assert(picture.grid.step <= kMostStep);
    const auto columns = static_cast<int>(picture.grid.columns());
    // Pixels before the first place are between it and nothing.
    std::vector<std::vector<uint32_t>> missing(picture.grid.rows() + 1);
    parallel_ranges(missing.size(), 4, [&](size_t first, size_t last) {
        Square square{};
        SquareLight light;
        for (size_t row = first; row < last; ++row)
            for (int column = -1; column < columns; ++column) {
                collect(picture, column, static_cast<int>(row) - 1, square);
                HWY_DYNAMIC_DISPATCH(LightSquare)(picture, square, light);
                for (size_t i = 0; i < static_cast<size_t>(square.count); ++i) {
                    if (light.weights[i] >= kLeastUpsampleWeight)
                        picture.radiance[square.pixels[i]] +=
                            glm::vec4(light.r[i], light.g[i], light.b[i], 0);
                    else if (light.weights[i] >= 0)
                        missing[row].push_back(square.pixels[i]);
                }
            }
    });
    std::vector<uint32_t> all;
    for (const auto& some : missing) all.insert(all.end(), some.begin(), some.end());
    return all;
}

}  // namespace lucarne::gi::paths::native
#endif
