#include "gi/engines/vpl/shadow_maps/native/splat.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "gi/engines/vpl/shadow_maps/native/casters.h"
#include "gi/engines/vpl/shadow_maps/native/map_frame.h"
#include "gi/engines/vpl/shadow_maps/queue.h"
#include "gi/engines/vpl/shadow_maps/splats.h"
#include "gi/shared/surfel.h"
#include "io/core/parallel.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/engines/vpl/shadow_maps/native/splat.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/engines/vpl/shadow_maps/native/casters-inl.h"
#include "gi/engines/vpl/shadow_maps/native/texel-inl.h"
#include "gi/native/vectors-inl.h"

#ifndef LUCARNE_NATIVE_SPLAT_ONCE
#define LUCARNE_NATIVE_SPLAT_ONCE
namespace lucarne::gi::vpl::native {

/// Maps that are drawn together: blocks are decoded once for all of them.
constexpr uint32_t kGroup = 16;

/// How often the discs of a map may cover it, counted by their boxes. Thinned discs cover it some ten times.
/// A million discs at the place of a VPL would cover it a million times, so those that come later are left
/// out.
constexpr uint64_t kMostLayers = 512;

/// Tables of the rays through the middles of a map's columns, u from -1 to 1; rows have the same. They save a
/// division at each texel.
struct MapColumns {
    std::vector<float> squares, rays;  ///< u^2 and 2 u
    explicit MapColumns(uint32_t side) : squares(side), rays(side) {
        for (uint32_t x = 0; x < side; ++x) {
            const float u = (2 * static_cast<float>(x) + 1) / static_cast<float>(side) - 1;
            squares[x] = u * u;
            rays[x] = 2 * u;
        }
    }
};

struct SplatJob {
    const SplatMemory& memory;
    const SplatLayout& layout;
    const CasterTables& tables;
    const MapColumns& columns;
    uint32_t first_map, map_end;
};

}  // namespace lucarne::gi::vpl::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace gi::native::HWY_NAMESPACE;

/// Returns a bit for each map into which a block may have to be drawn, see cull.comp.
uint32_t cull(const SplatJob& job, const MapFrame* maps, uint32_t block) {
    const float* bounds = job.memory.bounds + size_t{block} * kBoundsWords;
    const glm::vec3 low(bounds[0], bounds[1], bounds[2]), high(bounds[4], bounds[5], bounds[6]);
    const float most_area = bounds[3], most_radius = bounds[7];
    const float needed = thinned_area(job.layout.splat_angle);
    uint32_t met = 0;
    for (uint32_t i = 0; i < job.map_end - job.first_map; ++i) {
        const glm::vec3 centre(maps[i].centre), normal(maps[i].normal);
        const glm::vec3 outside = glm::clamp(centre, low, high) - centre;
        if (!(most_area >= needed * glm::dot(outside, outside))) continue;
        const glm::vec3 farthest = glm::max(centre - low, high - centre);
        const glm::vec3 top(normal.x > 0 ? high.x : low.x, normal.y > 0 ? high.y : low.y,
                            normal.z > 0 ? high.z : low.z);
        const float height = glm::dot(normal, top - centre);
        const bool above =
            height + most_radius + kLargestSplat * job.layout.splat_angle * glm::length(farthest) > 0;
        met |= above ? 1u << i : 0u;
    }
    return met;
}

/// The casters of a block that have to be drawn into a map, see enqueue.comp. Positions are relative to the
/// map's centre.
size_t enqueue(const SplatJob& job, const MapFrame& map, const Casters& casters, Casters& queued) {
    const Floats df;
    const F largest = set(kLargestSplat * job.layout.splat_angle), zero = hn::Zero(df);
    size_t count = 0;
    for (size_t i = 0; i < kBlockSurfels; i += hn::Lanes(df)) {
        const V3 offset{sub(hn::Load(df, casters.x + i), set(map.centre.x)),
                        sub(hn::Load(df, casters.y + i), set(map.centre.y)),
                        sub(hn::Load(df, casters.z + i), set(map.centre.z))};
        const V3 normal{hn::Load(df, casters.nx + i), hn::Load(df, casters.ny + i),
                        hn::Load(df, casters.nz + i)};
        const F radius = hn::Load(df, casters.radius + i), scale = hn::Load(df, casters.scale + i);
        const F distance2 = dot(offset, offset), distance = hn::Sqrt(distance2);
        const Mask faces = hn::Eq(dot(normal, normal), zero);
        const F least = hn::IfThenElse(faces, set(1.0f), set(kLeastSlant));
        const F along = hn::Max(hn::Abs(dot(normal, offset)), mul(least, distance));
        Mask drawn = hn::Gt(dot(offset, map.normal), sub(hn::Neg(radius), mul(largest, distance)));
        drawn = hn::And(drawn, hn::Ge(mul(scale, along), mul(distance2, distance)));
        const size_t more = hn::CountTrue(df, drawn);
        if (more == 0) continue;
        const auto keep = [&](F value, float* to) { hn::StoreU(hn::Compress(value, drawn), df, to + count); };
        keep(offset.x, queued.x);
        keep(offset.y, queued.y);
        keep(offset.z, queued.z);
        keep(normal.x, queued.nx);
        keep(normal.y, queued.ny);
        keep(normal.z, queued.nz);
        keep(radius, queued.radius);
        const U id = hn::Load(Words(), casters.id + i);
        hn::StoreU(hn::Compress(id, hn::RebindMask(Words(), drawn)), Words(), queued.id + count);
        count += more;
    }
    return count;
}

/// Discs in a map, lane by lane; see MapDisc in disc.glsl.
struct MapDiscs {
    alignas(64) float x[kLanes], y[kLanes], z[kLanes], nx[kLanes], ny[kLanes], nz[kLanes];
    alignas(64) float radius2[kLanes], core2[kLanes], lowest[kLanes], offset[kLanes];
    alignas(64) uint32_t surface[kLanes];
    alignas(64) int32_t x0[kLanes], y0[kLanes], x1[kLanes], y1[kLanes];
};

/// Computes discs and their boxes, disc_over() and map_box() in disc.glsl. Returns those that may be hit.
HWY_INLINE uint32_t set_up(const SplatJob& job, const MapFrame& map, const Casters& from, size_t at,
                           size_t count, MapDiscs& discs) {
    const Floats df;
    const Ints di;
    const F zero = hn::Zero(df), one = set(1.0f);
    const V3 offset{hn::LoadU(df, from.x + at), hn::LoadU(df, from.y + at), hn::LoadU(df, from.z + at)};
    V3 normal{hn::LoadU(df, from.nx + at), hn::LoadU(df, from.ny + at), hn::LoadU(df, from.nz + at)};
    const F own = hn::LoadU(df, from.radius + at);
    const F distance = hn::Sqrt(hn::Max(dot(offset, offset), set(1e-12f)));
    const F nearer = over(one, distance);
    normal = choose(hn::Eq(dot(normal, normal), zero), scaled(offset, hn::Neg(nearer)), normal);
    const F slant = mul(hn::Abs(dot(normal, offset)), nearer);
    const F grown =
        over(mul(set(job.layout.splat_angle), distance), hn::Sqrt(hn::Max(slant, set(kLeastSlant))));
    const F radius = hn::Max(own, grown);
    const F cosine = dot(normal, map.normal);
    const F lowest =
        hn::IfThenElseZero(hn::Gt(hn::Abs(cosine), set(kOwnSheet)), mul(set(kSheetTolerance), radius));
    const V3 centre{dot(offset, map.tangent), dot(offset, map.bitangent), dot(offset, map.normal)};
    const F top = add(centre.z, mul(radius, hn::Sqrt(hn::Max(sub(one, mul(cosine, cosine)), zero))));
    Mask hit = hn::And(hn::Gt(top, lowest), hn::FirstN(df, count - at));
    const V3 turned{dot(normal, map.tangent), dot(normal, map.bitangent), cosine};
    const F core = hn::Max(own, mul(set(kCore), radius));
    const F inverse = over(one, hn::Sqrt(dot(centre, centre)));
    const F sine = hn::Min(mul(radius, inverse), one);
    const F opposite = add(mul(centre.z, inverse), hn::Sqrt(sub(one, mul(sine, sine))));
    const Mask circle = hn::And(hn::Gt(opposite, zero), hn::Lt(sine, one));
    const F reach = over(sine, opposite), side = set(static_cast<float>(job.layout.side)), half = set(0.5f);
    const F last = sub(side, one);
    const auto range = [&](F along, int32_t* first_texel, int32_t* last_texel) {
        const F middle = over(mul(along, inverse), opposite);
        const F low = hn::IfThenElse(circle, hn::Max(sub(middle, reach), set(-1.0f)), set(-1.0f)),
                high = hn::IfThenElse(circle, hn::Min(add(middle, reach), one), one);
        const auto texel = [&](F v) { return sub(mul(add(mul(v, half), half), side), half); };
        const F first = hn::Max(hn::Ceil(texel(low)), zero), end = hn::Min(hn::Floor(texel(high)), last);
        hit = hn::And(hit, hn::Le(first, end));
        hn::Store(to_int(di, first), di, first_texel);
        hn::Store(to_int(di, end), di, last_texel);
    };
    range(centre.x, discs.x0, discs.x1);
    range(centre.y, discs.y0, discs.y1);
    const F plane = dot(turned, centre);
    const Mask away = hn::Gt(plane, zero);
    const V3 toward = choose(away, {hn::Neg(turned.x), hn::Neg(turned.y), hn::Neg(turned.z)}, turned);
    hn::Store(centre.x, df, discs.x);
    hn::Store(centre.y, df, discs.y);
    hn::Store(centre.z, df, discs.z);
    hn::Store(turned.x, df, discs.nx);
    hn::Store(turned.y, df, discs.ny);
    hn::Store(turned.z, df, discs.nz);
    hn::Store(mul(radius, radius), df, discs.radius2);
    hn::Store(mul(core, core), df, discs.core2);
    hn::Store(lowest, df, discs.lowest);
    hn::Store(plane, df, discs.offset);
    hn::Store(map_surface(own, toward), Words(), discs.surface);
    return bits_of(hit);
}

/// log2 of positive numbers, off by less than 1e-4: the distances of sources are coded in steps of 2 %.
HWY_INLINE Row log2_of(Row v) {
    const RowFloats df;
    const RowInts di;
    const auto bits = hn::BitCast(di, v);
    const auto exponent = hn::Sub(hn::ShiftRight<23>(bits), hn::Set(di, 127));
    const Row m = hn::BitCast(df, hn::Or(hn::And(bits, hn::Set(di, 0x7fffff)), hn::Set(di, 0x3f800000)));
    // log2(m) = 2 / ln 2 * atanh(q), q = (m - 1) / (m + 1).
    const Row q = hn::Div(hn::Sub(m, hn::Set(df, 1.0f)), hn::Add(m, hn::Set(df, 1.0f))), q2 = hn::Mul(q, q);
    Row sum = hn::Add(hn::Mul(q2, hn::Set(df, 1 / 7.0f)), hn::Set(df, 1 / 5.0f));
    sum = hn::Add(hn::Mul(q2, sum), hn::Set(df, 1 / 3.0f));
    sum = hn::Add(hn::Mul(q2, sum), hn::Set(df, 1.0f));
    return hn::Add(hn::ConvertTo(df, exponent), hn::Mul(hn::Mul(q, sum), hn::Set(df, 2.88539008f)));
}

HWY_INLINE void take(hn::Vec<RowWords> code, hn::Mask<RowFloats> covers, uint32_t* HWY_RESTRICT texels) {
    const RowWords du;
    const auto held = hn::LoadU(du, texels);
    hn::StoreU(hn::IfThenElse(hn::RebindMask(du, covers), hn::Min(code, held), held), du, texels);
}

/// Draws a disc into a map that begins at texel `first` of the atlas.
HWY_INLINE void draw(const SplatJob& job, const MapDiscs& discs, size_t lane, uint32_t id, size_t first) {
    const RowFloats df;
    const RowWords du;
    const auto row_of = [&](float v) { return hn::Set(df, v); };
    const Row zero = hn::Zero(df), one = row_of(1.0f);
    const Row cx = row_of(discs.x[lane]), cy = row_of(discs.y[lane]), cz = row_of(discs.z[lane]);
    const Row nx = row_of(discs.nx[lane]), ny = row_of(discs.ny[lane]), nz = row_of(discs.nz[lane]);
    const Row offset = row_of(discs.offset[lane]), radius2 = row_of(discs.radius2[lane]),
              core2 = row_of(discs.core2[lane]), lowest = row_of(discs.lowest[lane]);
    const auto surface = hn::Set(du, discs.surface[lane]);
    // Vectors begin at the disc, so most discs need one in each row. The last one of a row may overlap the
    // one before it: a texel that is taken twice keeps its value.
    const int last_vector = static_cast<int>(job.layout.side) - kRowLanes;
    const Row begin = row_of(static_cast<float>(discs.x0[lane])),
              end = row_of(static_cast<float>(discs.x1[lane]));
    for (int y = discs.y0[lane]; y <= discs.y1[lane]; ++y) {
        const Row v2 = row_of(job.columns.squares[static_cast<size_t>(y)]),
                  ray_y = row_of(job.columns.rays[static_cast<size_t>(y)]);
        for (int next = discs.x0[lane]; next <= discs.x1[lane]; next += kRowLanes) {
            const int x = std::min(next, last_vector);
            const Row column = hn::Iota(df, static_cast<float>(x));
            const Row uv2 = hn::Add(hn::LoadU(df, job.columns.squares.data() + x), v2);
            const Row ray_x = hn::LoadU(df, job.columns.rays.data() + x), ray_z = hn::Sub(one, uv2);
            const Row t =
                hn::Div(offset, hn::Add(hn::Add(hn::Mul(nx, ray_x), hn::Mul(ny, ray_y)), hn::Mul(nz, ray_z)));
            const Row hit_z = hn::Mul(t, ray_z);
            const Row ox = hn::Sub(hn::Mul(t, ray_x), cx), oy = hn::Sub(hn::Mul(t, ray_y), cy),
                      oz = hn::Sub(hit_z, cz);
            const Row square = hn::Add(hn::Add(hn::Mul(ox, ox), hn::Mul(oy, oy)), hn::Mul(oz, oz));
            auto hit = hn::And(hn::Gt(t, zero), hn::Le(square, radius2));
            hit = hn::And(hit, hn::Gt(hit_z, lowest));
            hit = hn::And(hit, hn::And(hn::Ge(column, begin), hn::Le(column, end)));
            if (hn::AllFalse(df, hit)) continue;
            const auto in_core = hn::Le(square, core2);
            const auto core = hn::And(hit, in_core), rest = hn::AndNot(in_core, hit);
            const Row distance = hn::Mul(t, hn::Add(one, uv2));
            const Row inside = distances_within(du, distance);
            const auto code = pack_map_texels(du, inside, surface);
            const size_t at = first + static_cast<size_t>(y) * job.layout.side + static_cast<size_t>(x);
            take(code, core, job.memory.atlas + at);
            take(code, rest, job.memory.fringe + at);
            if (!job.memory.sources) continue;
            // pack_source() of sources.glsl.
            const Row octaves = hn::Add(log2_of(hn::Div(inside, row_of(job.layout.cut_size))), row_of(14.0f));
            const Row share = hn::Min(hn::Max(hn::Mul(octaves, row_of(1 / 16.0f)), zero), one);
            const uint32_t most = (1u << (32 - job.layout.id_bits)) - 1;
            const auto far =
                hn::BitCast(du, to_int(RowInts(), hn::Mul(share, row_of(static_cast<float>(most)))));
            const auto source =
                hn::Or(hn::ShiftLeftSame(far, static_cast<int>(job.layout.id_bits)), hn::Set(du, id));
            take(source, core, job.memory.sources + at);
            take(source, rest, job.memory.fringe_sources + at);
        }
    }
}

void DrawMaps(const SplatJob& job) {
    MapFrame maps[kGroup];
    for (uint32_t map = job.first_map; map < job.map_end; ++map)
        maps[map - job.first_map] = frame_of(job.memory.lights[map]);
    Casters casters, queued;
    MapDiscs discs;
    const size_t map_texels = size_t{job.layout.side} * job.layout.side;
    uint64_t texels[kGroup] = {};  // in the boxes of what was drawn
    for (uint32_t block = 0; block < job.memory.blocks; ++block) {
        uint32_t met = cull(job, maps, block);
        if (met == 0) continue;
        decode_casters(job.memory.casters, job.tables, block, casters);
        for (; met; met &= met - 1) {
            const auto i = static_cast<uint32_t>(std::countr_zero(met));
            if (texels[i] >= kMostLayers * map_texels) continue;
            const size_t count = enqueue(job, maps[i], casters, queued);
            for (size_t at = 0; at < count; at += hn::Lanes(Floats()))
                for (uint32_t left = set_up(job, maps[i], queued, at, count, discs); left; left &= left - 1) {
                    const auto lane = static_cast<size_t>(std::countr_zero(left));
                    texels[i] += static_cast<uint64_t>(discs.x1[lane] - discs.x0[lane] + 1) *
                                 static_cast<uint64_t>(discs.y1[lane] - discs.y0[lane] + 1);
                    draw(job, discs, lane, queued.id[at + lane], (job.first_map + i) * map_texels);
                }
        }
    }
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::vpl::native {

HWY_EXPORT(DrawMaps);
void splat(const SplatMemory& memory, const SplatLayout& layout) {
    const CasterTables tables(layout.cut_size, layout.splat_angle);
    const MapColumns columns(layout.side);
    const auto maps = static_cast<uint32_t>(memory.lights.size());
    parallel_ranges(maps, kGroup, [&](size_t first, size_t end) {
        HWY_DYNAMIC_DISPATCH(DrawMaps)
        ({memory, layout, tables, columns, static_cast<uint32_t>(first), static_cast<uint32_t>(end)});
    });
}

}  // namespace lucarne::gi::vpl::native
#endif
