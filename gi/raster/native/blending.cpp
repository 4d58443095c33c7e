#include "gi/raster/native/blending.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "gi/raster/blend_sums.h"
#include "gi/raster/blend_weights.h"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/raster/native/blending.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/raster/native/disc-inl.h"

#ifndef LUCARNE_NATIVE_BLENDING_ONCE
#define LUCARNE_NATIVE_BLENDING_ONCE
namespace lucarne::gi::native {

using raster::kCosCrease, raster::kCosSmooth, raster::kLeastWeight, raster::kLeastWeightAt,
    raster::kPixelReach, raster::kSlab;

constexpr int kStride = kBlendingTile + 16;  ///< vectors may reach over the right border
constexpr uint32_t kNoSurface = UINT32_MAX;

/// The front surfaces of a row of pixels, and the sums of the discs on them (blend_sums.h). Planes of a whole
/// tile would lie at multiples of 4 KiB, which caches hold badly.
struct BlendingRow {
    alignas(64) uint32_t surface[kStride];  ///< material and kSurfelHasNormal: only equal ones are blended
    float depth[kStride], scale[kStride], inverse_radius[kStride], nx[kStride], ny[kStride], nz[kStride];
    uint32_t sums[raster::kSumWords][kStride];
};
struct BlendingTile {
    BlendingRow rows[kBlendingTile];
};

/// Tables for the 10-bit codes of colours.
struct ColourTables {
    static constexpr int kRoots = 4096;
    std::array<int32_t, 1024> steps;     ///< by code: the linear value in steps of a sum
    std::array<float, 1026> thresholds;  ///< by code: the least linear value that has it
    std::array<int32_t, kRoots> codes;   ///< by the root of a value: the code at the start of its step

    ColourTables() {
        for (uint32_t code = 0; code < 1024; ++code)
            steps[code] = static_cast<int32_t>(
                srgb_to_linear(static_cast<float>(code) / 1023) * raster::kValueSteps + 0.5f);
        thresholds[0] = 0;
        for (int code = 1; code < 1024; ++code)
            thresholds[static_cast<size_t>(code)] = srgb_to_linear((static_cast<float>(code) - 0.5f) / 1023);
        thresholds[1024] = thresholds[1025] = std::numeric_limits<float>::infinity();
        int32_t code = 0;
        for (int root = 0; root < kRoots; ++root) {
            const float value = static_cast<float>(root) / (kRoots - 1);
            while (thresholds[static_cast<size_t>(code) + 1] <= value * value) ++code;
            codes[static_cast<size_t>(root)] = code;
        }
    }
};
inline const ColourTables& colour_tables() {
    static const ColourTables tables;
    return tables;
}

}  // namespace lucarne::gi::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::native::HWY_NAMESPACE {

constexpr size_t kMostLanes = HWY_MAX_BYTES / 4;

/// What is the same in all pixels of a disc, see `Contribution` in blend.glsl.
struct Contribution {
    uint32_t surface;
    float nx, ny, nz, radius;
    int32_t values[6];  ///< colour and normal in steps of a sum
};

/// Adds a disc to the sums of eight pixels. `distance2`: in radii; `z`: the disc's depths.
HWY_INLINE void contribute(const Contribution& c, Row distance2, Row z, hn::Mask<RowFloats> inside, size_t at,
                           BlendingRow& row) {
    const RowFloats df;
    const RowInts di;
    const auto set_row = [&](float v) { return hn::Set(df, v); };
    const Row one = set_row(1.0f), zero = hn::Zero(df);
    const Row rest = hn::Max(hn::Sub(one, distance2), zero);
    Row weight = hn::Mul(hn::Mul(rest, rest), rest);
    auto adds = hn::And(inside, hn::Ge(weight, set_row(kLeastWeight)));
    const auto surface = hn::LoadU(RowWords(), row.surface + at);
    adds = hn::And(adds, hn::RebindMask(df, hn::Eq(surface, hn::Set(RowWords(), c.surface))));
    if (hn::AllFalse(df, adds)) return;
    const Row offset = hn::Mul(hn::Sub(z, hn::LoadU(df, row.depth + at)), hn::LoadU(df, row.scale + at));
    const Row half = set_row(0.5f);
    const Row wide = hn::Min(hn::Mul(set_row(c.radius), hn::LoadU(df, row.inverse_radius + at)), one);
    adds = hn::And(adds, hn::Le(hn::Abs(offset), hn::Add(half, hn::Mul(half, wide))));
    const Row alike = hn::Add(hn::Add(hn::Mul(hn::LoadU(df, row.nx + at), set_row(c.nx)),
                                      hn::Mul(hn::LoadU(df, row.ny + at), set_row(c.ny))),
                              hn::Mul(hn::LoadU(df, row.nz + at), set_row(c.nz)));
    const Row smooth = hn::Mul(hn::Sub(alike, set_row(kCosCrease)), set_row(1 / (kCosSmooth - kCosCrease)));
    weight = hn::Mul(weight, hn::Min(hn::Max(smooth, zero), one));
    adds = hn::And(adds, hn::Ge(weight, set_row(kLeastWeight)));
    if (hn::AllFalse(df, adds)) return;
    const auto steps = hn::IfThenElseZero(
        hn::RebindMask(di, adds), to_int(di, hn::Add(hn::Mul(weight, set_row(raster::kWeightSteps)), half)));
    const auto sum = [&](uint32_t channel, hn::Vec<RowInts> value) {
        auto* HWY_RESTRICT to = reinterpret_cast<int32_t*>(row.sums[channel] + at);
        hn::StoreU(hn::Add(hn::LoadU(di, to), value), di, to);
    };
    sum(0, steps);
    for (uint32_t channel = 0; channel < 6; ++channel)
        sum(channel + 1, hn::Mul(steps, hn::Set(di, c.values[channel])));
    const Row place = hn::Mul(hn::Add(hn::Mul(half, offset), half), set_row(raster::kValueSteps));
    sum(7, hn::Mul(steps, to_int(di, hn::Add(hn::IfThenElseZero(adds, place), half))));
}

/// The discs of one step, lane by lane: widened ellipses, and what they contribute.
struct BlendedDiscs : EllipseLanes {
    alignas(64) float radius[kMostLanes];
    alignas(64) float nx[kMostLanes], ny[kMostLanes], nz[kMostLanes];
    alignas(64) uint32_t surface[kMostLanes];
    alignas(64) int32_t values[6][kMostLanes];

    Contribution contribution(size_t lane) const {
        Contribution c{surface[lane], nx[lane], ny[lane], nz[lane], radius[lane], {}};
        for (size_t channel = 0; channel < 6; ++channel) c.values[channel] = values[channel][lane];
        return c;
    }
};

HWY_INLINE void blend_small(const BlendedDiscs& discs, size_t lane, const PixelRect& rect,
                            BlendingTile& tile) {
    const RowFloats df;
    const Contribution c = discs.contribution(lane);
    const Row x = hn::Set(df, discs.x[lane]), xx = hn::Set(df, discs.xx[lane]),
              xy = hn::Set(df, discs.xy[lane]), slope_x = hn::Set(df, discs.slope_x[lane]),
              z = hn::Set(df, discs.z[lane]), least = hn::Set(df, -2.0f * discs.radius[lane]),
              most = hn::Set(df, 2.0f * discs.radius[lane]),
              end = hn::Set(df, static_cast<float>(discs.x1[lane])), edge_x = hn::Set(df, discs.edge_x[lane]),
              one = hn::Set(df, 1.0f);
    const bool lined = discs.edge_x[lane] != 0 || discs.edge_y[lane] != 0;
    for (int row = discs.y0[lane]; row <= discs.y1[lane]; ++row) {
        const float dy = static_cast<float>(row) - discs.y[lane];
        const Row vdy = hn::Set(df, dy), from_y = hn::Set(df, discs.yy[lane] * dy * dy),
                  slope_y = hn::Set(df, discs.slope_y[lane] * dy);
        for (int column = discs.x0[lane]; column <= discs.x1[lane]; column += kRowLanes) {
            const Row place = hn::Iota(df, static_cast<float>(column)), dx = hn::Sub(place, x);
            const Row distance2 = hn::Add(hn::Mul(dx, hn::Add(hn::Mul(xx, dx), hn::Mul(xy, vdy))), from_y);
            const Row along = hn::Min(hn::Max(hn::Add(hn::Mul(slope_x, dx), slope_y), least), most);
            auto inside = hn::Le(place, end);
            if (lined)
                inside = hn::And(
                    inside, hn::Le(hn::Add(hn::Mul(edge_x, dx), hn::Set(df, discs.edge_y[lane] * dy)), one));
            contribute(c, distance2, hn::Add(z, along), inside, static_cast<size_t>(column - rect.x0),
                       tile.rows[row - rect.y0]);
        }
    }
}

/// blend_large() of blend_large.glsl for the pixels of a tile.
HWY_INLINE void blend_large(const ViewDisc& disc, const Contribution& c, const DiscView& view,
                            const PixelRect& rect, BlendingTile& tile) {
    const auto box = large_box(disc, view);
    if (!box || !box->rect.overlaps(rect)) return;
    const RowFloats df;
    const auto row_of = [&](float v) { return hn::Set(df, v); };
    const float r2 = disc.radius * disc.radius;
    const int x0 = std::max(box->rect.x0, rect.x0), x1 = std::min(box->rect.x1, rect.x1);
    for (int row = std::max(box->rect.y0, rect.y0); row < std::min(box->rect.y1, rect.y1); ++row) {
        const float tangent = row_tangent(view, row);
        for (int column = x0; column < x1; column += kRowLanes) {
            const Meeting m = meet(disc, view, tangent, column);
            const Row place = hn::Iota(df, static_cast<float>(column)), z = in_disc(disc, m.z);
            contribute(c, hn::Div(m.distance2, row_of(r2)), z,
                       hn::And(hn::Lt(place, row_of(static_cast<float>(x1))), hn::Le(m.beyond, row_of(1.0f))),
                       static_cast<size_t>(column - rect.x0), tile.rows[row - rect.y0]);
        }
    }
}

/// widened() of blend.comp.
HWY_INLINE void widen(Ellipses& e) {
    const F inverse = over(set(1.0f), determinant(e)), reach2 = set(kPixelReach * kPixelReach);
    const F a = add(mul(e.yy, inverse), reach2), b = mul(mul(set(-0.5f), e.xy), inverse),
            c = add(mul(e.xx, inverse), reach2);
    const F scale = over(set(1.0f), sub(mul(a, c), mul(b, b)));
    e.xx = mul(c, scale);
    e.xy = mul(mul(set(-2.0f), b), scale);
    e.yy = mul(a, scale);
}

/// Stores what discs contribute. Discs without a normal face the viewer.
HWY_INLINE void store_contributions(const DiscView& view, const BlockDiscs& found, size_t at,
                                    const Discs& discs, BlendedDiscs& lanes) {
    const Floats df;
    const Words du;
    const Ints di;
    const U b = hn::LoadU(du, found.b + at), c = hn::LoadU(du, found.c + at), d = hn::LoadU(du, found.d + at);
    const F one = set(1.0f), flat = set(orthographic(view) ? 0.0f : 1.0f);
    const V3 ray = to_world(view, {mul(over(discs.centre.x, discs.centre.z), flat),
                                   mul(over(discs.centre.y, discs.centre.z), flat), one});
    const V3 toward = normalized({hn::Neg(ray.x), hn::Neg(ray.y), hn::Neg(ray.z)});
    const V3 normal = choose(has_normal(d), decode_octahedral(c), toward);
    hn::Store(normal.x, df, lanes.nx);
    hn::Store(normal.y, df, lanes.ny);
    hn::Store(normal.z, df, lanes.nz);
    hn::Store(discs.radius, df, lanes.radius);
    hn::Store(hn::Or(hn::ShiftRight<24>(b), hn::And(d, word(kSurfelHasNormal))), du, lanes.surface);
    const int32_t* steps = colour_tables().steps.data();
    const U low = word(1023);
    const auto colour = [&](U code) {
        return hn::GatherIndex(di, steps, hn::BitCast(di, hn::And(code, low)));
    };
    hn::Store(colour(d), di, lanes.values[0]);
    hn::Store(colour(hn::ShiftRight<10>(d)), di, lanes.values[1]);
    hn::Store(colour(hn::ShiftRight<20>(d)), di, lanes.values[2]);
    const F half = set(0.5f);
    const auto value = [&](F v) {
        return to_int(di, add(mul(add(mul(half, v), half), set(raster::kValueSteps)), half));
    };
    hn::Store(value(normal.x), di, lanes.values[3]);
    hn::Store(value(normal.y), di, lanes.values[4]);
    hn::Store(value(normal.z), di, lanes.values[5]);
}

/// Adds the discs of a block to the sums.
void blend_block(const CutMemory& cut, const DiscView& view, const PixelRect& rect, uint32_t block,
                 BlendingTile& tile) {
    BlockDiscs found;
    find_discs(cut, view, rect, block, found);
    const Floats df;
    const F low_x = set(static_cast<float>(rect.x0)), low_y = set(static_cast<float>(rect.y0)),
            high_x = set(static_cast<float>(rect.x1 - 1)), high_y = set(static_cast<float>(rect.y1 - 1));
    for (size_t i = 0; i < found.count; i += hn::Lanes(df)) {
        Discs discs;
        Mask drawn = load_discs(found, i, view, discs);
        const Mask small = are_small(view, discs);
        BlendedDiscs lanes;
        store_contributions(view, found, i, discs, lanes);
        if (const uint32_t large = bits_of(hn::AndNot(small, drawn)))
            each_large(large, discs, [&](size_t lane, const ViewDisc& disc) {
                blend_large(disc, lanes.contribution(lane), view, rect, tile);
            });
        Ellipses e = project(view, discs);
        widen(e);
        const F inverse = determinant(e), most = set(kSmallRadius + 2), share = set(kLeastWeightAt);
        const F reach_x = hn::Min(hn::Sqrt(over(mul(share, e.yy), inverse)), most),
                reach_y = hn::Min(hn::Sqrt(over(mul(share, e.xx), inverse)), most);
        const F x0 = hn::Max(hn::Ceil(sub(e.x, reach_x)), low_x),
                y0 = hn::Max(hn::Ceil(sub(e.y, reach_y)), low_y),
                x1 = hn::Min(hn::Floor(add(e.x, reach_x)), high_x),
                y1 = hn::Min(hn::Floor(add(e.y, reach_y)), high_y);
        drawn = hn::And(hn::And(drawn, small), hn::And(hn::Le(x0, x1), hn::Le(y0, y1)));
        store(e, discs.centre.z, x0, y0, x1, y1, lanes);
        for (uint32_t left = bits_of(drawn); left; left &= left - 1)
            blend_small(lanes, static_cast<size_t>(std::countr_zero(left)), rect, tile);
    }
}

struct Texels {
    U depth, normal, albedo, material;
};

/// Fills the planes of a row from its texels, see slab_of() in slab.glsl.
void read_row(const DiscView& view, const PixelRect& rect, int y, const GBufferTexel* texels,
              BlendingRow& row) {
    const Floats df;
    const bool flat = orthographic(view);
    const int width = rect.x1 - rect.x0;
    const F tangent_y = set(flat ? 0.0f : row_tangent(view, y)), zero = hn::Zero(df), one = set(1.0f);
    for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(df))) {
        alignas(64) GBufferTexel lanes[kMostLanes] = {};
        std::memcpy(lanes, texels + x,
                    sizeof(GBufferTexel) * static_cast<size_t>(std::min<int>(hn::Lanes(df), width - x)));
        Texels t;
        hn::LoadInterleaved4(Words(), reinterpret_cast<const uint32_t*>(lanes), t.depth, t.normal, t.albedo,
                             t.material);
        const F tangent_x = flat ? zero : column_tangents(df, view, rect.x0 + x);
        V3 normal = decode_octahedral(t.normal);
        const Mask turned = hn::RebindMask(df, hn::TestBit(t.albedo, word(kTexelFromBehind)));
        normal = choose(turned, {hn::Neg(normal.x), hn::Neg(normal.y), hn::Neg(normal.z)}, normal);
        const F radius = half_value(hn::ShiftRight<16>(t.material));
        const V3 ray = to_world(view, {tangent_x, tangent_y, one});
        const F scale = over(hn::Max(hn::Abs(dot(normal, ray)), set(1e-4f)),
                             mul(set(kSlab), hn::Max(radius, set(1e-6f))));
        const U surface =
            hn::Or(hn::And(t.material, word(0xffffu)), hn::And(t.albedo, word(kSurfelHasNormal)));
        const auto empty = hn::Eq(t.depth, word(0));
        const auto at = static_cast<size_t>(x);
        hn::StoreU(hn::IfThenElse(empty, word(kNoSurface), surface), Words(), row.surface + at);
        hn::StoreU(hn::BitCast(df, t.depth), df, row.depth + at);
        hn::StoreU(scale, df, row.scale + at);
        hn::StoreU(over(one, hn::Max(radius, set(1e-30f))), df, row.inverse_radius + at);
        hn::StoreU(normal.x, df, row.nx + at);
        hn::StoreU(normal.y, df, row.ny + at);
        hn::StoreU(normal.z, df, row.nz + at);
    }
}

/// Converts words, rounded to nearest: both halves are exact.
HWY_INLINE F any_to_float(U v) {
    return add(mul(to_float(hn::ShiftRight<16>(v)), set(65536.0f)), to_float(hn::And(v, word(0xffffu))));
}

/// Codes a linear value from 0 to 1 in 10 bits, see encode_albedo().
HWY_INLINE U encode_colour(F value) {
    const Ints di;
    const ColourTables& tables = colour_tables();
    const F root = hn::Min(hn::Sqrt(hn::Max(value, hn::Zero(Floats()))), set(1.0f));
    const auto code = hn::GatherIndex(
        di, tables.codes.data(), to_int(di, mul(root, set(static_cast<float>(ColourTables::kRoots - 1)))));
    const F next = hn::GatherIndex(Floats(), tables.thresholds.data() + 1, code);
    const auto up = hn::RebindMask(di, hn::Ge(value, next));
    return hn::BitCast(Words(), hn::Add(code, hn::IfThenElseZero(up, hn::Set(di, 1))));
}

/// Writes the texels of a row, see blend_resolve.comp.
void write_row(const DiscView& view, const PixelRect& rect, int y, GBufferTexel* texels,
               const BlendingRow& row) {
    const Floats df;
    const bool flat = orthographic(view);
    const int width = rect.x1 - rect.x0;
    const F tangent_y = set(flat ? 0.0f : row_tangent(view, y)), zero = hn::Zero(df), one = set(1.0f),
            two = set(2.0f);
    for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(df))) {
        const auto at = static_cast<size_t>(x);
        const auto sum = [&](size_t channel) { return hn::LoadU(Words(), row.sums[channel] + at); };
        const U weight = sum(0);
        const auto blended =
            hn::And(hn::Ne(weight, word(0)), hn::Eq(hn::Min(weight, word(raster::kMostWeight)), weight));
        if (hn::AllFalse(Words(), blended)) continue;
        alignas(64) GBufferTexel lanes[kMostLanes] = {};
        const size_t bytes =
            sizeof(GBufferTexel) * static_cast<size_t>(std::min<int>(hn::Lanes(df), width - x));
        std::memcpy(lanes, texels + x, bytes);
        Texels t;
        hn::LoadInterleaved4(Words(), reinterpret_cast<const uint32_t*>(lanes), t.depth, t.normal, t.albedo,
                             t.material);
        const F weights = any_to_float(hn::Max(weight, word(1)));  // no NaN in pixels without discs
        const F scale = over(one, mul(weights, set(raster::kValueSteps)));
        const auto mean = [&](size_t channel) { return mul(any_to_float(sum(channel)), scale); };
        const auto signed_mean = [&](size_t channel) {
            return sub(mul(mul(two, any_to_float(sum(channel))), scale), one);
        };
        const V3 normal{signed_mean(4), signed_mean(5), signed_mean(6)};
        const F depth = add(hn::BitCast(df, t.depth), over(signed_mean(7), hn::LoadU(df, row.scale + at)));
        const F tangent_x = flat ? zero : column_tangents(df, view, rect.x0 + x);
        const Mask behind = hn::Gt(dot(normal, to_world(view, {tangent_x, tangent_y, one})), zero);
        const V3 facing = choose(behind, {hn::Neg(normal.x), hn::Neg(normal.y), hn::Neg(normal.z)}, normal);
        const U colour = hn::Or(hn::Or(encode_colour(mean(1)), hn::ShiftLeft<10>(encode_colour(mean(2)))),
                                hn::ShiftLeft<20>(encode_colour(mean(3))));
        const U flag = hn::And(t.albedo, word(kSurfelHasNormal));
        const auto turned = hn::And(hn::Ne(flag, word(0)), hn::RebindMask(Words(), behind));
        const U albedo = hn::Or(hn::Or(colour, flag), hn::IfThenElseZero(turned, word(kTexelFromBehind)));
        hn::StoreInterleaved4(hn::IfThenElse(blended, hn::BitCast(Words(), depth), t.depth),
                              hn::IfThenElse(blended, encode_octahedral(normalized(facing)), t.normal),
                              hn::IfThenElse(blended, albedo, t.albedo), t.material, Words(),
                              reinterpret_cast<uint32_t*>(lanes));
        std::memcpy(static_cast<void*>(texels + x), lanes, bytes);
    }
}

void BlendTile(const CutMemory& cut, const DiscView& view, const PixelRect& rect,
               std::span<const PlacedBlock* const> blocks, GBufferTexel* texels) {
    if (blocks.empty()) return;
    const auto tile = std::make_unique_for_overwrite<BlendingTile>();
    const auto texels_of = [&](int y) {
        return texels + static_cast<size_t>(y) * view.width + static_cast<size_t>(rect.x0);
    };
    for (int y = rect.y0; y < rect.y1; ++y) {
        BlendingRow& row = tile->rows[y - rect.y0];
        std::ranges::fill(row.surface, kNoSurface);
        std::memset(row.sums, 0, sizeof(row.sums));
        read_row(view, rect, y, texels_of(y), row);
    }
    for (const PlacedBlock* block : blocks) blend_block(cut, view, rect, block->block, *tile);
    for (int y = rect.y0; y < rect.y1; ++y) write_row(view, rect, y, texels_of(y), tile->rows[y - rect.y0]);
}

}  // namespace lucarne::gi::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::native {

HWY_EXPORT(BlendTile);
void draw_blending(const CutMemory& cut, const DiscView& view, const PixelRect& tile,
                   std::span<const PlacedBlock* const> blocks, GBufferTexel* texels) {
    HWY_DYNAMIC_DISPATCH(BlendTile)(cut, view, tile, blocks, texels);
}

}  // namespace lucarne::gi::native
#endif
