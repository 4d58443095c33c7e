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
inline bool may_meet(const float* bounds, const SkyMap& map, const SkyAxes& axes) {
    const glm::vec3 low(bounds[0], bounds[1], bounds[2]), high(bounds[4], bounds[5], bounds[6]);
    if (low.x > high.x) return false;  // no surfel
    const glm::vec3 middle = (low + high) / 2.0f, half = (high - low) / 2.0f;
    const float radius = bounds[7] * kSkyRadius;
    const auto meets = [&](const glm::vec4& row, const glm::vec3& axis, float size, uint32_t texels) {
        const float at = glm::dot(glm::vec3(row), middle) + row.w;
        const float reach = (glm::dot(glm::abs(axis), half) + radius) / size;
        return at + reach >= 0 && at - reach <= static_cast<float>(texels);
    };
    // Behind all receivers nothing is shaded.
    const float nearest = glm::dot(axes.away, middle) + map.away.w - glm::dot(glm::abs(axes.away), half);
    if (nearest > map.farthest + radius) return false;
    return meets(map.across, axes.across, axes.width, map.columns) &&
           meets(map.down, axes.down, axes.height, map.rows);
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
    alignas(64) uint32_t code[kLanes];  ///< of the discs in single texels
    uint32_t wide;                      ///< those that may cover more than one texel
    uint32_t single;                    ///< those that cover one
};

/// Numbers of casters of a block.
struct SkyQueue {
    alignas(64) int32_t casters[Casters::kRoom];
};

/// Queues the casters that may cover a texel if they face the light: less than a third. Returns their
/// number.
size_t enqueue(const SkyMap& map, const SkyAxes& axes, const Casters& casters, SkyQueue& queue) {
    const Floats df;
    const Ints di;
    const F zero = hn::Zero(df);
    size_t count = 0;
    for (size_t i = 0; i < kBlockSurfels; i += hn::Lanes(df)) {
        const V3 position{hn::Load(df, casters.x + i), hn::Load(df, casters.y + i),
                          hn::Load(df, casters.z + i)};
        const F radius = hn::Load(df, casters.radius + i);
        const auto covers = [&](const glm::vec4& row, float size, uint32_t texels) {
            const F place = add(dot(position, row), set(row.w - 0.5f)), reach = mul(radius, set(1 / size));
            const F first = hn::Max(hn::Ceil(sub(place, reach)), zero);
            const F last = hn::Min(hn::Floor(add(place, reach)), set(static_cast<float>(texels - 1)));
            return hn::Le(first, last);
        };
        const Mask met = hn::And(
            hn::And(covers(map.across, axes.width, map.columns), covers(map.down, axes.height, map.rows)),
            hn::Gt(radius, zero));
        const auto numbers = hn::Iota(di, static_cast<int32_t>(i));
        hn::StoreU(hn::Compress(numbers, hn::RebindMask(di, met)), di, queue.casters + count);
        count += hn::CountTrue(df, met);
    }
    return count;
}

/// Computes discs from the queued casters from `at` on, see draw.comp. Most cover a single texel, or none.
HWY_INLINE void set_up(const SkyDrawing& drawing, const SkyMap& map, const SkyAxes& axes,
                       const Casters& casters, const SkySurfaces& surfaces, const SkyQueue& queue, size_t at,
                       size_t count, SkyDiscs& discs) {
    const Floats df;
    const Ints di;
    const F zero = hn::Zero(df), one = set(1.0f), half = set(0.5f);
    const Mask used = hn::FirstN(df, count - at);
    const auto number = hn::IfThenElseZero(hn::RebindMask(di, used), hn::LoadU(di, queue.casters + at));
    const auto of = [&](const float* values) { return hn::GatherIndex(df, values, number); };
    const V3 position{of(casters.x), of(casters.y), of(casters.z)};
    const V3 stored{of(casters.nx), of(casters.ny), of(casters.nz)};
    const F radius = of(casters.radius);
    Mask hit = used, one_texel = hit;
    const auto range = [&](F along, const glm::vec3& axis, float size, uint32_t texels, F& first,
                           int32_t* from, int32_t* to) {
        const F cosine = dot(stored, glm::vec4(axis, 0));
        const F reach =
            mul(radius, mul(hn::Sqrt(hn::Max(sub(one, mul(cosine, cosine)), zero)), set(1 / size)));
        first = hn::Max(hn::Ceil(sub(sub(along, reach), half)), zero);
        const F last = hn::Min(hn::Floor(sub(add(along, reach), half)), set(static_cast<float>(texels - 1)));
        hit = hn::And(hit, hn::Le(first, last));
        one_texel = hn::And(one_texel, hn::Eq(first, last));
        hn::Store(to_int(di, first), di, from);
        hn::Store(to_int(di, last), di, to);
        return cosine;
    };
    const F x = add(dot(position, map.across), set(map.across.w));
    const F y = add(dot(position, map.down), set(map.down.w));
    F first_x, first_y;
    const F across = range(x, axes.across, axes.width, map.columns, first_x, discs.x0, discs.x1);
    const F down = range(y, axes.down, axes.height, map.rows, first_y, discs.y0, discs.y1);
    const F toward = hn::Neg(dot(stored, map.away));
    const Mask plain = hn::Eq(dot(stored, stored), zero);
    // Discs in the plane of the light block none.
    hit = hn::And(hit, hn::Or(plain, hn::Gt(hn::Abs(toward), set(kSkyEdgeOn))));
    discs.wide = discs.single = 0;
    if (hn::AllFalse(df, hit)) return;
    const F z = add(dot(position, map.away), set(map.away.w));
    const F per_toward = hn::IfThenZeroElse(plain, over(one, toward));
    const F slope_x = mul(across, per_toward), slope_y = mul(down, per_toward), radius2 = mul(radius, radius);
    const auto code = [&](const uint32_t* codes) { return hn::GatherIndex(Words(), codes, number); };
    const U front = code(surfaces.front), back = code(surfaces.back);
    U surface = hn::IfThenElse(hn::RebindMask(Words(), hn::Gt(toward, zero)), front, back);
    surface = hn::IfThenElse(hn::RebindMask(Words(), plain),
                             hn::Or(hn::AndNot(word(0xfffu), front), word(axes.surface_normal)), surface);
    discs.wide = bits_of(hn::AndNot(one_texel, hit));
    if (discs.wide) {
        hn::Store(x, df, discs.x);
        hn::Store(y, df, discs.y);
        hn::Store(z, df, discs.z);
        hn::Store(slope_x, df, discs.slope_x);
        hn::Store(slope_y, df, discs.slope_y);
        hn::Store(radius2, df, discs.radius2);
        hn::Store(surface, Words(), discs.surface);
    }
    const F dx = mul(sub(add(first_x, half), x), set(axes.width));
    const F dy = mul(sub(add(first_y, half), y), set(axes.height));
    const F dz = add(mul(slope_x, dx), mul(slope_y, dy));
    const F square = add(add(mul(dx, dx), mul(dy, dy)), mul(dz, dz));
    const Mask covers = hn::And(hn::And(hit, one_texel), hn::Le(square, radius2));
    discs.single = bits_of(covers);
    if (!discs.single) return;
    const F steps = over(add(z, dz), set(drawing.depth_step));
    const F inside = hn::Min(hn::Max(steps, zero), set(kSkyDepthSteps));
    const U depth = hn::BitCast(Words(), to_int(di, hn::IfThenElseZero(covers, inside)));
    hn::Store(hn::Or(hn::ShiftLeft<16>(depth), surface), Words(), discs.code);
}

/// Draws a disc into a map: few discs cover more than some texels.
HWY_INLINE void draw(const SkyDrawing& drawing, const SkyAxes& axes, const SkyDiscs& discs, size_t lane,
                     size_t columns, uint32_t* texels) {
    for (int32_t y = discs.y0[lane]; y <= discs.y1[lane]; ++y)
        for (int32_t x = discs.x0[lane]; x <= discs.x1[lane]; ++x) {
            const float dx = (static_cast<float>(x) + 0.5f - discs.x[lane]) * axes.width;
            const float dy = (static_cast<float>(y) + 0.5f - discs.y[lane]) * axes.height;
            const float dz = discs.slope_x[lane] * dx + discs.slope_y[lane] * dy;
            if (dx * dx + dy * dy + dz * dz > discs.radius2[lane]) continue;
            uint32_t& texel = texels[static_cast<size_t>(y) * columns + static_cast<size_t>(x)];
            texel =
                std::min(texel, pack_sky_texel(discs.z[lane] + dz, drawing.depth_step, discs.surface[lane]));
        }
}

HWY_INLINE void take(const SkyDiscs& discs, size_t lane, size_t columns, uint32_t* texels) {
    uint32_t& texel =
        texels[static_cast<size_t>(discs.y0[lane]) * columns + static_cast<size_t>(discs.x0[lane])];
    texel = std::min(texel, discs.code[lane]);
}

void DrawSky(const SkyJob& job) {
    const SkyDrawing& drawing = job.drawing;
    std::vector<SkyAxes> axes;
    for (size_t map = job.first_map; map < job.map_end; ++map) axes.emplace_back(drawing.maps[map]);
    Casters casters;
    SkySurfaces surfaces;
    SkyQueue queue;
    SkyDiscs discs;
    for (uint32_t block = 0; block < drawing.blocks; ++block) {
        bool decoded = false;
        for (size_t i = 0; i < axes.size(); ++i) {
            const SkyMap& map = drawing.maps[job.first_map + i];
            if (!may_meet(drawing.bounds + size_t{block} * kBoundsWords, map, axes[i])) continue;
            if (!decoded) {
                decode_casters(drawing.casters, job.tables, block, casters);
                code_surfaces(casters, surfaces);
                decoded = true;
            }
            uint32_t* texels = drawing.texels + map.first;
            const size_t count = enqueue(map, axes[i], casters, queue);
            for (size_t at = 0; at < count; at += hn::Lanes(Floats())) {
                set_up(drawing, map, axes[i], casters, surfaces, queue, at, count, discs);
                for (uint32_t left = discs.single; left; left &= left - 1)
                    take(discs, static_cast<size_t>(std::countr_zero(left)), map.columns, texels);
                for (uint32_t left = discs.wide; left; left &= left - 1)
                    draw(drawing, axes[i], discs, static_cast<size_t>(std::countr_zero(left)), map.columns,
                         texels);
            }
        }
    }
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::vpl::native {

HWY_EXPORT(DrawSky);
void draw_sky_maps(const SkyDrawing& drawing) {
    CasterTables tables(drawing.cut_size, 1.0f);
    for (float& radius : tables.radii) radius *= kSkyRadius;
    parallel_ranges(drawing.maps.size(), kSkyGroup, [&](size_t first, size_t end) {
        HWY_DYNAMIC_DISPATCH(DrawSky)({drawing, tables, first, end});
    });
}

}  // namespace lucarne::gi::vpl::native
#endif
