#include "gi/raster/native/visibility.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <memory>

// All targets have the same results; those left out differ little from the ones before them.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/raster/native/visibility.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/raster/native/disc-inl.h"

#ifndef LUCARNE_NATIVE_VISIBILITY_ONCE
#define LUCARNE_NATIVE_VISIBILITY_ONCE
namespace lucarne::gi::native {

constexpr int kCell = 8;  ///< pixels: side of the cells whose farthest order is known
constexpr int kCells = kVisibilityTile / kCell;
constexpr int kStride = kVisibilityTile + 16;  ///< vectors may reach over the right border

/// Orders and ids of a tile's pixels. Orders are the bits of positive floats, so integers compare like
/// depths.
struct VisibilityRow {
    alignas(64) uint32_t keys[kStride];
    uint32_t ids[kStride];
};
struct VisibilityTile {
    VisibilityRow rows[kVisibilityTile];
    uint32_t farthest[kCells * kCells];  ///< largest order in each cell when it was last computed
};

}  // namespace lucarne::gi::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::native::HWY_NAMESPACE {

/// The small discs of one step, lane by lane.
struct SmallDiscs : EllipseLanes {
    alignas(64) float push[kMost], home_x[kMost], home_y[kMost];
};

/// Gives pixels to a disc where its order is smaller, or equal and its id smaller.
HWY_INLINE void take(Row order, hn::Mask<RowFloats> covers, uint32_t id, int x, VisibilityRow& row) {
    const RowWords du;
    uint32_t *HWY_RESTRICT keys = row.keys + x, *HWY_RESTRICT ids = row.ids + x;
    const auto key = hn::BitCast(du, order);
    const auto covered = hn::RebindMask(du, covers);
    const auto held = hn::LoadU(du, keys), owner = hn::LoadU(du, ids), own = hn::Set(du, id);
    const auto equal = hn::Eq(key, held);
    const auto nearer = hn::And(covered, hn::Eq(hn::Min(key, held), key));
    const auto winner = hn::IfThenElse(equal, hn::Min(own, owner), own);
    hn::StoreU(hn::IfThenElse(nearer, key, held), du, keys);
    hn::StoreU(hn::IfThenElse(nearer, winner, owner), du, ids);
}

HWY_INLINE void draw_small(const SmallDiscs& discs, size_t lane, uint32_t id, const PixelRect& rect,
                           VisibilityTile& tile) {
    const RowFloats df;
    const auto x = hn::Set(df, discs.x[lane]), xx = hn::Set(df, discs.xx[lane]),
               xy = hn::Set(df, discs.xy[lane]), slope_x = hn::Set(df, discs.slope_x[lane]),
               push = hn::Set(df, discs.push[lane]), z = hn::Set(df, discs.z[lane]), one = hn::Set(df, 1.0f),
               home = hn::Set(df, discs.home_x[lane]), edge_x = hn::Set(df, discs.edge_x[lane]);
    const bool lined = discs.edge_x[lane] != 0 || discs.edge_y[lane] != 0;
    const auto end = hn::Set(df, static_cast<float>(discs.x1[lane]));
    for (int row = discs.y0[lane]; row <= discs.y1[lane]; ++row) {
        const float y = static_cast<float>(row), dy = y - discs.y[lane];
        const auto vdy = hn::Set(df, dy), from_y = hn::Set(df, discs.yy[lane] * dy * dy),
                   slope = hn::Set(df, discs.slope_y[lane] * dy);
        const bool home_row = y == discs.home_y[lane];
        for (int column = discs.x0[lane]; column <= discs.x1[lane]; column += kRowLanes) {
            const auto place = hn::Iota(df, static_cast<float>(column));
            const auto dx = hn::Sub(place, x);
            const auto distance2 = hn::Add(hn::Mul(dx, hn::Add(hn::Mul(xx, dx), hn::Mul(xy, vdy))), from_y);
            const auto inside = hn::Le(distance2, one);
            auto covered = inside;
            if (lined)
                covered = hn::And(
                    covered, hn::Le(hn::Add(hn::Mul(edge_x, dx), hn::Set(df, discs.edge_y[lane] * dy)), one));
            if (home_row) covered = hn::Or(covered, hn::Eq(place, home));
            covered = hn::And(covered, hn::Le(place, end));
            const auto along = hn::Add(hn::Add(hn::Mul(slope_x, dx), slope), hn::Mul(push, distance2));
            const auto key = hn::Add(z, hn::IfThenElse(inside, along, push));
            take(key, covered, id, column - rect.x0, tile.rows[row - rect.y0]);
        }
    }
}

/// disc_key() for all pixels of the tile that a large disc may cover.
HWY_INLINE void draw_large(const ViewDisc& disc, uint32_t id, const DiscView& view, const PixelRect& rect,
                           VisibilityTile& tile) {
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
            const auto inside = hn::And(hn::Le(m.distance2, row_of(r2)), hn::Le(m.beyond, row_of(1.0f)));
            auto covered = inside;
            if (row == box->home.y)
                covered = hn::Or(covered, hn::Eq(place, row_of(static_cast<float>(box->home.x))));
            covered = hn::And(covered, hn::Gt(z, row_of(view.forward.w)));
            covered = hn::And(covered, hn::Lt(place, row_of(static_cast<float>(x1))));
            Row share = row_of(1.0f);
            if (r2 > 0) share = hn::IfThenElse(inside, hn::Div(m.distance2, row_of(r2)), share);
            const Row key = hn::Add(z, hn::Mul(row_of(disc.push), share));
            take(key, covered, id, column - rect.x0, tile.rows[row - rect.y0]);
        }
    }
}

/// Draws the discs of a block. Returns whether there are large discs among them.
bool draw_block(const CutMemory& cut, const DiscView& view, const PixelRect& rect, uint32_t block,
                VisibilityTile& tile) {
    BlockDiscs found;
    find_discs(cut, view, rect, block, found);
    bool has_large = false;
    const Floats df;
    const F zero = hn::Zero(df);
    const F low_x = set(static_cast<float>(rect.x0)), low_y = set(static_cast<float>(rect.y0)),
            high_x = set(static_cast<float>(rect.x1 - 1)), high_y = set(static_cast<float>(rect.y1 - 1));
    const F last_x = set(static_cast<float>(view.width) - 1),
            last_y = set(static_cast<float>(view.height) - 1);
    for (size_t i = 0; i < found.count; i += hn::Lanes(df)) {
        Discs discs;
        Mask drawn = load_discs(found, i, view, discs);
        const Mask small = are_small(view, discs);
        if (const uint32_t large = bits_of(hn::AndNot(small, drawn))) {
            has_large = true;
            each_large(large, discs, [&](size_t lane, const ViewDisc& disc) {
                draw_large(disc, found.id[i + lane], view, rect, tile);
            });
        }
        drawn = hn::And(drawn, small);
        const Ellipses e = project(view, discs);
        const F home_x = hn::Floor(add(e.x, set(0.5f))), home_y = hn::Floor(add(e.y, set(0.5f)));
        const F inverse = determinant(e), most = set(kSmallRadius + 1);
        const F reach_x = hn::Min(hn::Sqrt(over(e.yy, inverse)), most),
                reach_y = hn::Min(hn::Sqrt(over(e.xx, inverse)), most);
        const F x0 = hn::Max(hn::Max(hn::Min(hn::Ceil(sub(e.x, reach_x)), home_x), zero), low_x),
                y0 = hn::Max(hn::Max(hn::Min(hn::Ceil(sub(e.y, reach_y)), home_y), zero), low_y),
                x1 = hn::Min(hn::Min(hn::Max(hn::Floor(add(e.x, reach_x)), home_x), last_x), high_x),
                y1 = hn::Min(hn::Min(hn::Max(hn::Floor(add(e.y, reach_y)), home_y), last_y), high_y);
        drawn = hn::And(drawn, hn::And(hn::Le(x0, x1), hn::Le(y0, y1)));
        SmallDiscs lanes;
        store(e, discs.centre.z, x0, y0, x1, y1, lanes);
        hn::Store(discs.push, df, lanes.push);
        hn::Store(home_x, df, lanes.home_x);
        hn::Store(home_y, df, lanes.home_y);
        for (uint32_t left = bits_of(drawn); left; left &= left - 1) {
            const auto lane = static_cast<size_t>(std::countr_zero(left));
            draw_small(lanes, lane, found.id[i + lane], rect, tile);
        }
    }
    return has_large;
}

/// Computes the farthest orders of the cells that a rectangle touches.
void refresh(const PixelRect& cells, VisibilityTile& tile) {
    const RowWords du;
    for (int y = cells.y0; y < cells.y1; ++y)
        for (int x = cells.x0; x < cells.x1; ++x) {
            auto most = hn::Zero(du);
            for (int row = 0; row < kCell; ++row)
                for (int column = 0; column < kCell; column += kRowLanes)
                    most = hn::Max(most, hn::Load(du, tile.rows[y * kCell + row].keys + x * kCell + column));
            tile.farthest[y * kCells + x] = hn::GetLane(hn::MaxOfLanes(du, most));
        }
}

/// half of packHalf2x16(vec2(0, v)) in GLSL, rounded to nearest even, v >= 0.
HWY_INLINE U half_bits(F v) {
    const U bits = hn::BitCast(Words(), v);
    const U even = hn::And(hn::ShiftRight<13>(bits), word(1));
    const U rounded = hn::ShiftRight<13>(hn::Add(hn::Add(bits, word(0xfffu)), even));
    const U usual = hn::Sub(rounded, word(112u << 10));
    // Halves below 2^-14 are fixed-point numbers: adding .5 moves their bits to the end.
    const U tiny = hn::Sub(hn::BitCast(Words(), add(v, set(0.5f))), word(0x3f000000u));
    const auto is_tiny = hn::RebindMask(Words(), hn::Lt(v, set(6.103515625e-05f)));
    const auto is_large = hn::RebindMask(Words(), hn::Ge(v, set(65520.0f)));
    return hn::IfThenElse(is_large, word(0x7c00u), hn::IfThenElse(is_tiny, tiny, usual));
}

/// Writes the texels of a row of pixels, `count` of them from (x, y) on.
void resolve_row(const CutMemory& cut, const DiscView& view, int x, int y, int count, const uint32_t* ids,
                 GBufferTexel* texels) {
    const auto lanes = static_cast<int>(hn::Lanes(Floats()));
    const bool flat = orthographic(view);
    const F tangent_y = set(row_tangent(view, y)), zero = hn::Zero(Floats()), one = set(1.0f);
    for (int at = 0; at < count; at += lanes) {
        const U id = hn::LoadU(Words(), ids + at);
        const auto taken = hn::Ne(id, word(kNoSurfel));
        const FoundSurfels found = find_surfels(cut, hn::IfThenElseZero(taken, id));
        const Packed& packed = found.packed;
        Discs discs;
        place_discs(view, packed, found.origin, found.size, found.radius, discs);
        turn_discs(view, packed.c, packed.d, discs);
        const F tangent_x = column_tangents(Floats(), view, x + at);
        const V3 ray{flat ? zero : tangent_x, flat ? zero : tangent_y, one};
        // disc_depth()
        const F slope = dot(discs.normal, ray);
        const V3 from_start{flat ? sub(discs.centre.x, tangent_x) : discs.centre.x,
                            flat ? sub(discs.centre.y, tangent_y) : discs.centre.y, discs.centre.z};
        F depth = over(dot(discs.normal, from_start), slope);
        depth = hn::Min(hn::Max(depth, sub(discs.centre.z, discs.extent)), add(discs.centre.z, discs.extent));
        depth = hn::IfThenElse(hn::Lt(hn::Abs(slope), set(1e-12f)), discs.centre.z, depth);
        const Mask turned = has_normal(packed.d);
        V3 normal = choose(turned, to_view(view, decode_octahedral(packed.c)), discs.normal);
        const Mask behind = hn::Gt(dot(normal, ray), zero);
        normal = choose(behind, {hn::Neg(normal.x), hn::Neg(normal.y), hn::Neg(normal.z)}, normal);
        const U from_behind =
            hn::IfThenElseZero(hn::RebindMask(Words(), hn::And(behind, turned)), word(kTexelFromBehind));
        const U material = hn::Or(hn::ShiftRight<24>(packed.b), hn::ShiftLeft<16>(half_bits(discs.radius)));
        alignas(64) uint32_t words[4 * HWY_MAX_BYTES / 4];
        hn::StoreInterleaved4(
            hn::IfThenElseZero(taken, hn::BitCast(Words(), depth)),
            hn::IfThenElseZero(taken, encode_octahedral(to_world(view, normal))),
            hn::IfThenElseZero(taken, hn::Or(hn::AndNot(word(kSurfelHasEdge), packed.d), from_behind)),
            hn::IfThenElseZero(taken, material), Words(), words);
        std::memcpy(texels + at, words,
                    sizeof(GBufferTexel) * static_cast<size_t>(std::min(lanes, count - at)));
    }
}

void DrawTile(const CutMemory& cut, const DiscView& view, const PixelRect& rect,
              std::span<const PlacedBlock* const> blocks, const VisibilityTarget& target) {
    constexpr int kRefresh = 4;  // blocks between two computations of the farthest orders
    const auto tile = std::make_unique_for_overwrite<VisibilityTile>();
    const int width = rect.x1 - rect.x0, height = rect.y1 - rect.y0;
    for (int y = 0; y < kVisibilityTile; ++y) {
        VisibilityRow& row = tile->rows[y];
        std::ranges::fill(row.keys, 0u);  // outside the picture nothing is ever in front
        if (y < height) std::fill_n(row.keys, width, kNoKey);
        std::ranges::fill(row.ids, kNoSurfel);
    }
    std::ranges::fill(tile->farthest, kNoKey);
    const auto cells_of = [&](const PixelRect& r) {
        const auto cell = [](int at) { return std::clamp(at, 0, kVisibilityTile) / kCell; };
        const auto end = [](int at) { return (std::clamp(at, 0, kVisibilityTile) + kCell - 1) / kCell; };
        return PixelRect{cell(r.x0 - rect.x0), cell(r.y0 - rect.y0), end(r.x1 - rect.x0),
                         end(r.y1 - rect.y0)};
    };
    const auto mark = [&](uint32_t block) {
        std::atomic_ref(target.blended[block]).store(1, std::memory_order_relaxed);
    };
    PixelRect stale{kCells, kCells, 0, 0};
    int drawn = 0;
    for (const PlacedBlock* block : blocks) {
        const PixelRect cells = cells_of(block->rect);
        const uint32_t nearest = block->nearest > 0 ? std::bit_cast<uint32_t>(block->nearest) : 0;
        uint32_t farthest = 0;
        for (int y = cells.y0; y < cells.y1; ++y)
            for (int x = cells.x0; x < cells.x1; ++x)
                farthest = std::max(farthest, tile->farthest[y * kCells + x]);
        if (nearest > farthest) continue;
        // Large discs are blended even if they are nearest nowhere, as by the shaders.
        if (draw_block(cut, view, rect, block->block, *tile)) mark(block->block);
        stale = {std::min(stale.x0, cells.x0), std::min(stale.y0, cells.y0), std::max(stale.x1, cells.x1),
                 std::max(stale.y1, cells.y1)};
        if (++drawn % kRefresh) continue;
        refresh(stale, *tile);
        stale = {kCells, kCells, 0, 0};
    }
    for (int y = rect.y0; y < rect.y1; ++y) {
        const uint32_t* ids = tile->rows[y - rect.y0].ids;
        const size_t at = static_cast<size_t>(y) * view.width + static_cast<size_t>(rect.x0);
        std::copy(ids, ids + width, target.ids + at);
        resolve_row(cut, view, rect.x0, y, width, ids, target.texels + at);
        for (int x = 0; x < width; ++x)
            if (ids[x] != kNoSurfel) mark(ids[x] / kBlockSurfels);
    }
}

}  // namespace lucarne::gi::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::native {

HWY_EXPORT(DrawTile);
void draw_visibility(const CutMemory& cut, const DiscView& view, const PixelRect& tile,
                     std::span<const PlacedBlock* const> blocks, const VisibilityTarget& target) {
    HWY_DYNAMIC_DISPATCH(DrawTile)(cut, view, tile, blocks, target);
}

}  // namespace lucarne::gi::native
#endif
