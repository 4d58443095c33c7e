#include "gi/engines/vpl/sky/native/draw.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/engines/vpl/shadow_maps/native/casters.h"
#include "io/core/parallel.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/engines/vpl/sky/native/draw.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/engines/vpl/shadow_maps/native/casters-inl.h"

#ifndef LUCARNE_NATIVE_SKY_DRAW_ONCE
#define LUCARNE_NATIVE_SKY_DRAW_ONCE
namespace lucarne::gi::vpl::native {

/// Maps that are drawn together: blocks are decoded once for all of them.
constexpr size_t kSkyGroup = 16;

struct SkyJob {
    const SkyDrawing& drawing;
    const CasterTables& tables;
    size_t first_map, map_end;
};

/// The axes of a map as unit vectors, and the size of its texels, m.
struct SkyAxes {
    glm::vec3 across, down, away;
    float width, height;
    uint32_t
        surface_normal;  ///< of surfels without a normal, which face the light: map_surface() without radius
    explicit SkyAxes(const SkyMap& map)
        : across(map.across),
          down(map.down),
          away(map.away),
          width(1 / glm::length(across)),
          height(1 / glm::length(down)),
          surface_normal(map_surface(1.0f, -away) & 0xfffu) {
        across *= width;
        down *= height;
    }
};

/// Returns whether any caster of a block may cover a texel of a map.
inline bool may_meet(const float* bounds, const SkyMap& map, const SkyAxes& axes, uint32_t side) {
    const glm::vec3 low(bounds[0], bounds[1], bounds[2]), high(bounds[4], bounds[5], bounds[6]);
    if (low.x > high.x) return false;  // no surfel
    const glm::vec3 middle = (low + high) / 2.0f, half = (high - low) / 2.0f;
    const auto meets = [&](const glm::vec4& row, const glm::vec3& axis, float size) {
        const float at = glm::dot(glm::vec3(row), middle) + row.w;
        const float reach = (glm::dot(glm::abs(axis), half) + bounds[7]) / size;
        return at + reach >= 0 && at - reach <= static_cast<float>(side);
    };
    return meets(map.across, axes.across, axes.width) && meets(map.down, axes.down, axes.height);
}

}  // namespace lucarne::gi::vpl::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {

/// The codes of the surfaces of a block's casters, on the side of their normal and on the other one.
struct SkySurfaces {
    alignas(64) uint32_t front[Casters::kRoom], back[Casters::kRoom];
};

void code_surfaces(const Casters& casters, SkySurfaces& surfaces) {
    const Floats df;
    for (size_t i = 0; i < kBlockSurfels; i += hn::Lanes(df)) {
        const F radius = hn::Load(df, casters.radius + i);
        const V3 n{hn::Load(df, casters.nx + i), hn::Load(df, casters.ny + i), hn::Load(df, casters.nz + i)};
        hn::Store(map_surface(radius, n), Words(), surfaces.front + i);
        hn::Store(map_surface(radius, {hn::Neg(n.x), hn::Neg(n.y), hn::Neg(n.z)}), Words(),
                  surfaces.back + i);
    }
}

/// Discs in a map, lane by lane: places in texels and metres, normals along the map's axes.
struct SkyDiscs {
    alignas(64) float x[kLanes], y[kLanes], z[kLanes], slope_x[kLanes], slope_y[kLanes], radius2[kLanes];
    alignas(64) uint32_t surface[kLanes];
    alignas(64) int32_t x0[kLanes], y0[kLanes], x1[kLanes], y1[kLanes];
};

/// Computes discs from the casters from `at` on, see draw.comp. Returns those that may cover a texel.
HWY_INLINE uint32_t set_up(const SkyMap& map, const SkyAxes& axes, float side, const Casters& casters,
                           const SkySurfaces& surfaces, size_t at, SkyDiscs& discs) {
    const Floats df;
    const Ints di;
    const F zero = hn::Zero(df), one = set(1.0f), half = set(0.5f);
    const V3 position{hn::Load(df, casters.x + at), hn::Load(df, casters.y + at),
                      hn::Load(df, casters.z + at)};
    const V3 stored{hn::Load(df, casters.nx + at), hn::Load(df, casters.ny + at),
                    hn::Load(df, casters.nz + at)};
    const F radius = hn::Load(df, casters.radius + at);
    Mask hit = hn::Gt(radius, zero);
    const auto range = [&](F along, const glm::vec3& axis, float size, int32_t* first_texel,
                           int32_t* last_texel) {
        const F cosine = dot(stored, glm::vec4(axis, 0));
        const F reach =
            mul(radius, mul(hn::Sqrt(hn::Max(sub(one, mul(cosine, cosine)), zero)), set(1 / size)));
        const F first = hn::Max(hn::Ceil(sub(sub(along, reach), half)), zero);
        const F last = hn::Min(hn::Floor(sub(add(along, reach), half)), set(side - 1));
        hit = hn::And(hit, hn::Le(first, last));
        hn::Store(to_int(di, first), di, first_texel);
        hn::Store(to_int(di, last), di, last_texel);
        return cosine;
    };
    const F x = add(dot(position, map.across), set(map.across.w));
    const F y = add(dot(position, map.down), set(map.down.w));
    const F across = range(x, axes.across, axes.width, discs.x0, discs.x1);
    const F down = range(y, axes.down, axes.height, discs.y0, discs.y1);
    const F toward = hn::Neg(dot(stored, map.away));
    const Mask plain = hn::Eq(dot(stored, stored), zero);
    // Discs in the plane of the light block none.
    hit = hn::And(hit, hn::Or(plain, hn::Gt(hn::Abs(toward), set(kSkyEdgeOn))));
    const uint32_t found = bits_of(hit);
    if (!found) return 0;
    const F per_toward = hn::IfThenZeroElse(plain, over(one, toward));
    hn::Store(x, df, discs.x);
    hn::Store(y, df, discs.y);
    hn::Store(add(dot(position, map.away), set(map.away.w)), df, discs.z);
    hn::Store(mul(across, per_toward), df, discs.slope_x);
    hn::Store(mul(down, per_toward), df, discs.slope_y);
    hn::Store(mul(radius, radius), df, discs.radius2);
    const U front = hn::Load(Words(), surfaces.front + at), back = hn::Load(Words(), surfaces.back + at);
    U surface = hn::IfThenElse(hn::RebindMask(Words(), hn::Gt(toward, zero)), front, back);
    surface = hn::IfThenElse(hn::RebindMask(Words(), plain),
                             hn::Or(hn::AndNot(word(0xfffu), front), word(axes.surface_normal)), surface);
    hn::Store(surface, Words(), discs.surface);
    return found;
}

/// Draws a disc into a map: few discs cover more than some texels.
HWY_INLINE void draw(const SkyDrawing& drawing, const SkyAxes& axes, const SkyDiscs& discs, size_t lane,
                     uint32_t* texels) {
    for (int32_t y = discs.y0[lane]; y <= discs.y1[lane]; ++y)
        for (int32_t x = discs.x0[lane]; x <= discs.x1[lane]; ++x) {
            const float dx = (static_cast<float>(x) + 0.5f - discs.x[lane]) * axes.width;
            const float dy = (static_cast<float>(y) + 0.5f - discs.y[lane]) * axes.height;
            const float dz = discs.slope_x[lane] * dx + discs.slope_y[lane] * dy;
            if (dx * dx + dy * dy + dz * dz > discs.radius2[lane]) continue;
            uint32_t& texel = texels[static_cast<size_t>(y) * drawing.side + static_cast<size_t>(x)];
            texel =
                std::min(texel, pack_sky_texel(discs.z[lane] + dz, drawing.depth_step, discs.surface[lane]));
        }
}

void DrawSky(const SkyJob& job) {
    const SkyDrawing& drawing = job.drawing;
    std::vector<SkyAxes> axes;
    for (size_t map = job.first_map; map < job.map_end; ++map) axes.emplace_back(drawing.maps[map]);
    const auto side = static_cast<float>(drawing.side);
    const size_t map_texels = size_t{drawing.side} * drawing.side;
    Casters casters;
    SkySurfaces surfaces;
    SkyDiscs discs;
    for (uint32_t block = 0; block < drawing.blocks; ++block) {
        bool decoded = false;
        for (size_t i = 0; i < axes.size(); ++i) {
            const SkyMap& map = drawing.maps[job.first_map + i];
            if (!may_meet(drawing.bounds + size_t{block} * kBoundsWords, map, axes[i], drawing.side))
                continue;
            if (!decoded) {
                decode_casters(drawing.casters, job.tables, block, casters);
                code_surfaces(casters, surfaces);
                decoded = true;
            }
            uint32_t* texels = drawing.texels + (job.first_map + i) * map_texels;
            for (size_t at = 0; at < kBlockSurfels; at += hn::Lanes(Floats()))
                for (uint32_t left = set_up(map, axes[i], side, casters, surfaces, at, discs); left;
                     left &= left - 1)
                    draw(drawing, axes[i], discs, static_cast<size_t>(std::countr_zero(left)), texels);
        }
    }
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::vpl::native {

HWY_EXPORT(DrawSky);
void draw_sky_maps(const SkyDrawing& drawing) {
    const CasterTables tables(drawing.cut_size, 1.0f);
    parallel_ranges(drawing.maps.size(), kSkyGroup, [&](size_t first, size_t end) {
        HWY_DYNAMIC_DISPATCH(DrawSky)({drawing, tables, first, end});
    });
}

}  // namespace lucarne::gi::vpl::native
#endif
