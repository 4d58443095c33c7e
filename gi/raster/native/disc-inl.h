// Surfels as discs in a view, several at a time: gi/shared/disc.h, disc.glsl and ellipse.glsl for vectors,
// which have no operators on all instruction sets. The operations and their order are the same, and none is
// fused, so that every instruction set gives the same bits (tests/gi/native/vectors_test.cpp compares them).
// Included once for each instruction set (Highway's foreach_target.h).
#if defined(LUCARNE_GI_RASTER_NATIVE_DISC_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LUCARNE_GI_RASTER_NATIVE_DISC_INL_H
#undef LUCARNE_GI_RASTER_NATIVE_DISC_INL_H
#else
#define LUCARNE_GI_RASTER_NATIVE_DISC_INL_H
#endif

#include "gi/native/vectors-inl.h"
#include "gi/raster/disc_view.h"
#include "gi/raster/native/area_roots.h"
#include "gi/raster/native/large_disc.h"
#include "gi/raster/native/tiles.h"
#include "gi/shared/disc.h"
#include "gi/shared/edge.h"
#include "gi/shared/gbuffer.h"
#include "gi/shared/surfel.h"

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::native::HWY_NAMESPACE {
HWY_INLINE V3 to_view(const DiscView& view, const V3& v) {
    return {dot(v, view.right), dot(v, view.down), dot(v, view.forward)};
}
HWY_INLINE V3 to_world(const DiscView& view, const V3& v) {
    const auto axis = [&](float right, float down, float forward) {
        return add(add(mul(v.x, set(right)), mul(v.y, set(down))), mul(v.z, set(forward)));
    };
    return {axis(view.right.x, view.down.x, view.forward.x), axis(view.right.y, view.down.y, view.forward.y),
            axis(view.right.z, view.down.z, view.forward.z)};
}
struct Packed {
    U a, b, c, d;
};
HWY_INLINE Packed load_packed(const PackedSurfel* from) {
    Packed p;
    hn::LoadInterleaved4(Words(), reinterpret_cast<const uint32_t*>(from), p.a, p.b, p.c, p.d);
    return p;
}
HWY_INLINE Mask has_normal(U flags) {
    return hn::RebindMask(Floats(), hn::TestBit(flags, word(kSurfelHasNormal)));
}

/// `origin` and `size`: of the surfels' cubes.
HWY_INLINE V3 surfel_position(const Packed& p, const V3& origin, F size) {
    const auto along = [&](F corner, U steps) {
        return add(corner, mul(size, over(add(to_float(steps), set(0.5f)), set(kFractionSteps))));
    };
    const U low = word(0xffffu);
    return {along(origin.x, hn::And(p.a, low)), along(origin.y, hn::ShiftRight<16>(p.a)),
            along(origin.z, hn::And(p.b, low))};
}

HWY_INLINE F pixels_per_tangent_x(const DiscView& view) {
    return set(static_cast<float>(view.width) / (2.0f * view.right.w));
}
HWY_INLINE F pixels_per_tangent_y(const DiscView& view) {
    return set(static_cast<float>(view.height) / (2.0f * view.down.w));
}
HWY_INLINE bool orthographic(const DiscView& view) {
    return view.origin.w > 0;
}
HWY_INLINE F view_scale(const DiscView& view, F depth) {
    return orthographic(view) ? set(1.0f) : depth;
}

/// Several discs, see ViewDisc.
struct Discs {
    V3 centre, normal, edge;
    F radius, extent, push;
};

/// Computes centres and radii. Returns which discs may be seen: before the near plane and within the sides of
/// the view.
HWY_INLINE Mask place_discs(const DiscView& view, const Packed& p, const V3& origin, F size, F radius,
                            Discs& discs) {
    V3 world = surfel_position(p, origin, size);
    world = {sub(world.x, set(view.origin.x)), sub(world.y, set(view.origin.y)),
             sub(world.z, set(view.origin.z))};
    discs.centre = to_view(view, world);
    Mask drawn = hn::Gt(radius, hn::Zero(Floats()));
    discs.radius = mul(set(view.size.scale), radius);
    drawn = hn::And(drawn, hn::Gt(discs.radius, hn::Zero(Floats())));
    const F scale = view_scale(view, discs.centre.z);
    if (view.size.pixels > 0 || view.size.most > 0) {
        const F least = hn::Min(pixels_per_tangent_x(view), pixels_per_tangent_y(view));
        const float diameter = view.size.pixels > 0 ? view.size.pixels : view.size.most;
        const F stated = over(mul(set(0.5f * diameter), hn::Max(scale, hn::Zero(Floats()))), least);
        discs.radius = view.size.pixels > 0 ? stated : hn::Min(discs.radius, stated);
    }
    drawn = hn::And(drawn, hn::Gt(add(discs.centre.z, discs.radius), set(view.forward.w)));
    const auto outside = [&](F along, float side) {
        const F beyond = sub(hn::Abs(along), mul(scale, set(side)));
        return orthographic(view) ? beyond : mul(beyond, set(1.0f / std::sqrt(1.0f + side * side)));
    };
    const F most = hn::Max(outside(discs.centre.x, view.right.w), outside(discs.centre.y, view.down.w));
    return hn::And(drawn, hn::Le(most, discs.radius));
}

/// Computes what place_discs() leaves out; `normals` and `flags` are words c and d of the surfels. Returns
/// which discs reach before the near plane and are not left out because they face away.
HWY_INLINE Mask turn_discs(const DiscView& view, U normals, U flags, Discs& discs) {
    const F one = set(1.0f), zero = hn::Zero(Floats());
    V3 toward{zero, zero, one};
    if (!orthographic(view)) {
        const F distance2 = dot(discs.centre, discs.centre);
        toward =
            choose(hn::Gt(distance2, zero), scaled(discs.centre, over(one, hn::Sqrt(distance2))), toward);
    }
    discs.push = mul(mul(set(kRimPush), discs.radius), toward.z);
    discs.normal = toward;
    Mask drawn = hn::Eq(zero, zero);
    if (view.size.front_only || !(view.size.pixels > 0)) {
        const V3 normal = to_view(view, decode_octahedral(normals));
        const Mask known = has_normal(flags);
        if (view.size.front_only) drawn = hn::Not(hn::And(known, hn::Gt(dot(normal, toward), zero)));
        if (!(view.size.pixels > 0)) discs.normal = choose(known, normal, toward);
    }
    const F across = hn::Max(sub(one, mul(discs.normal.z, discs.normal.z)), zero);
    discs.extent = mul(discs.radius, hn::Sqrt(across));
    return hn::And(drawn, hn::Gt(add(discs.centre.z, discs.extent), set(view.forward.w)));
}

/// Returns the lines at which discs end, see edge_of_code(). `b`, `normals`, `d`: words of the surfels;
/// `size`: of their cubes.
HWY_INLINE V3 disc_edges(const DiscView& view, U b, U normals, U d, F size) {
    const F zero = hn::Zero(Floats()), one = set(1.0f);
    const Mask lined = hn::RebindMask(Floats(), hn::TestBit(d, word(kSurfelHasEdge)));
    if (view.size.pixels > 0 || hn::AllFalse(Floats(), lined)) return {zero, zero, zero};
    const auto bits = [&](U from, uint32_t mask) { return hn::And(from, word(mask)); };
    const U code = hn::Or(
        hn::Or(bits(normals, 15u), bits(hn::ShiftRight<12>(normals), 240u)),
        hn::Or(hn::Or(hn::ShiftLeft<8>(bits(d, 3u)), bits(d, 0xc00u)), bits(hn::ShiftRight<8>(d), 0x3000u)));
    const F turn = over(to_float(hn::ShiftRight<7>(code)), set(kEdgeTurnSteps)), two = set(2.0f);
    const auto from = [&](float v) { return hn::Abs(sub(turn, set(v))); };
    const F u = sub(from(2), one),
            v = hn::IfThenElse(hn::Lt(turn, two), sub(one, from(1)), sub(from(3), one));
    const V3 n = decode_octahedral(normals), sizes{hn::Abs(n.x), hn::Abs(n.y), hn::Abs(n.z)};
    const auto rest = [&](F of_u, F of_v, F of_rest) {
        return over(hn::Neg(add(mul(of_u, u), mul(of_v, v))), of_rest);
    };
    V3 toward{u, v, rest(n.x, n.y, n.z)};
    toward = choose(hn::Ge(sizes.y, sizes.z), {v, rest(n.z, n.x, n.y), u}, toward);
    toward = choose(hn::And(hn::Ge(sizes.x, sizes.y), hn::Ge(sizes.x, sizes.z)), {rest(n.y, n.z, n.x), u, v},
                    toward);
    const auto area = hn::BitCast(Ints(), bits(hn::ShiftRight<16>(b), 255u));
    const F root = mul(size, hn::GatherIndex(Floats(), area_roots().data(), area));
    const F distance = mul(over(to_float(bits(code, kMostEdgeDistance)), set(kEdgeDistanceSteps)), root);
    const F scale = over(over(one, hn::Sqrt(dot(toward, toward))), distance);
    return choose(hn::And(lined, hn::Gt(distance, zero)), to_view(view, scaled(toward, scale)),
                  {zero, zero, zero});
}

/// Surfels by their ids, one a lane.
struct FoundSurfels {
    Packed packed;
    V3 origin;  ///< of their cubes
    F size;     ///< of their cubes, m
    F radius;   ///< m
};
HWY_INLINE FoundSurfels find_surfels(const CutMemory& cut, U id) {
    const auto words = [](const uint32_t* from, hn::Vec<Ints> index) {
        return hn::GatherIndex(Words(), from, index);
    };
    const auto floats = [](const float* from, hn::Vec<Ints> index) {
        return hn::GatherIndex(Floats(), from, index);
    };
    const auto* blocks = reinterpret_cast<const uint32_t*>(cut.blocks);
    const auto* items = reinterpret_cast<const float*>(cut.items);
    const auto* pool = reinterpret_cast<const uint32_t*>(cut.pool);
    const auto block = hn::BitCast(Ints(), hn::ShiftLeft<2>(hn::ShiftRight<8>(id)));
    const U in_block = hn::And(id, word(kBlockSurfels - 1));
    const U radius = hn::Add(words(cut.first_radius, hn::BitCast(Ints(), hn::ShiftRight<8>(id))), in_block);
    const auto cube = hn::BitCast(Ints(), hn::ShiftLeft<4>(words(blocks, block)));
    const auto four = hn::BitCast(Ints(), hn::ShiftLeft<2>(hn::Add(words(blocks + 1, block), in_block)));
    return {{words(pool, four), words(pool + 1, four), words(pool + 2, four), words(pool + 3, four)},
            {floats(items, cube), floats(items + 1, cube), floats(items + 2, cube)},
            floats(items + 3, cube),
            floats(cut.radii, hn::BitCast(Ints(), radius))};
}

static_assert(HWY_MAX_BYTES / 4 <= HostSurfels::kPadding);
HWY_INLINE Mask are_small(const DiscView& view, const Discs& discs) {
    const F most =
        hn::Max(mul(discs.radius, pixels_per_tangent_x(view)), mul(discs.radius, pixels_per_tangent_y(view)));
    return hn::Le(most, mul(set(kSmallRadius), view_scale(view, discs.centre.z)));
}

/// Several small discs in the picture, see ellipse.glsl.
struct Ellipses {
    F x, y;
    F xx, xy, yy;
    F slope_x, slope_y;
    F edge_x, edge_y;
};

HWY_INLINE Ellipses project(const DiscView& view, const Discs& discs) {
    const F scale = view_scale(view, discs.centre.z);
    const F per_x = pixels_per_tangent_x(view), per_y = pixels_per_tangent_y(view);
    const F place_x = over(discs.centre.x, scale), place_y = over(discs.centre.y, scale);
    const F flat = set(orthographic(view) ? 0.0f : 1.0f);
    const F tangent_x = mul(place_x, flat), tangent_y = mul(place_y, flat);
    Ellipses e;
    e.x = sub(add(mul(place_x, per_x), set(0.5f * static_cast<float>(view.width) - view.shift.x)), set(0.5f));
    e.y =
        sub(add(mul(place_y, per_y), set(0.5f * static_cast<float>(view.height) - view.shift.y)), set(0.5f));
    F facing = add(add(mul(discs.normal.x, tangent_x), mul(discs.normal.y, tangent_y)), discs.normal.z);
    facing = hn::IfThenElse(hn::Lt(hn::Abs(facing), set(1e-4f)), set(1e-4f), facing);
    const F step_x = over(scale, per_x), step_y = over(scale, per_y);
    e.slope_x = over(mul(hn::Neg(step_x), discs.normal.x), facing);
    e.slope_y = over(mul(hn::Neg(step_y), discs.normal.y), facing);
    const V3 along_x{add(mul(e.slope_x, tangent_x), step_x), mul(e.slope_x, tangent_y), e.slope_x};
    const V3 along_y{mul(e.slope_y, tangent_x), add(mul(e.slope_y, tangent_y), step_y), e.slope_y};
    e.edge_x = dot(discs.edge, along_x);
    e.edge_y = dot(discs.edge, along_y);
    const F inverse = over(set(1.0f), hn::Max(mul(discs.radius, discs.radius), set(1e-12f)));
    e.xx = mul(dot(along_x, along_x), inverse);
    e.xy = mul(mul(set(2.0f), dot(along_x, along_y)), inverse);
    e.yy = mul(dot(along_y, along_y), inverse);
    return e;
}
HWY_INLINE F determinant(const Ellipses& e) {
    return hn::Max(sub(mul(e.xx, e.yy), mul(mul(set(0.25f), e.xy), e.xy)), set(1e-12f));
}

/// Several ellipses lane by lane, with the depths of their centres and the pixels to test, x0 to x1 and y0 to
/// y1.
struct EllipseLanes {
    static constexpr size_t kMost = HWY_MAX_BYTES / 4;
    alignas(64) float x[kMost], y[kMost], xx[kMost], xy[kMost], yy[kMost], slope_x[kMost], slope_y[kMost],
        edge_x[kMost], edge_y[kMost], z[kMost];
    alignas(64) int32_t x0[kMost], y0[kMost], x1[kMost], y1[kMost];
};
HWY_INLINE void store(const Ellipses& e, F z, F x0, F y0, F x1, F y1, EllipseLanes& lanes) {
    const Floats df;
    const Ints di;
    hn::Store(e.x, df, lanes.x);
    hn::Store(e.y, df, lanes.y);
    hn::Store(e.xx, df, lanes.xx);
    hn::Store(e.xy, df, lanes.xy);
    hn::Store(e.yy, df, lanes.yy);
    hn::Store(e.slope_x, df, lanes.slope_x);
    hn::Store(e.slope_y, df, lanes.slope_y);
    hn::Store(e.edge_x, df, lanes.edge_x);
    hn::Store(e.edge_y, df, lanes.edge_y);
    hn::Store(z, df, lanes.z);
    hn::Store(to_int(di, x0), di, lanes.x0);
    hn::Store(to_int(di, y0), di, lanes.y0);
    hn::Store(to_int(di, x1), di, lanes.x1);
    hn::Store(to_int(di, y1), di, lanes.y1);
}

/// The discs of a block that may touch a tile, one after the other: on average a third of the block, because
/// its surfels lie anywhere in its node.
struct BlockDiscs {
    static constexpr size_t kRoom = kBlockSurfels + HWY_MAX_BYTES / 4;  // vectors may reach over the end
    alignas(64) float x[kRoom], y[kRoom], z[kRoom], radius[kRoom];
    alignas(64) uint32_t b[kRoom], c[kRoom], d[kRoom];  ///< words of the packed surfels
    alignas(64) uint32_t id[kRoom];
    float size;  ///< of the block's cube, m
    size_t count;
};

HWY_INLINE void find_discs(const CutMemory& cut, const DiscView& view, const PixelRect& tile, uint32_t block,
                           BlockDiscs& found) {
    const Floats df;
    const Words du;
    const CutBlock& from = cut.blocks[block];
    const CutItem& item = cut.items[from.item];
    const V3 origin{set(item.origin.x), set(item.origin.y), set(item.origin.z)};
    const F size = set(item.size);
    // Small discs reach no farther than their spheres; the margin is for the pixel of the centre, the affine
    // map and the width by which blending spreads discs.
    constexpr float kReach = kSmallRadius + 3;
    const F low_x = set(static_cast<float>(tile.x0) - kReach),
            low_y = set(static_cast<float>(tile.y0) - kReach),
            high_x = set(static_cast<float>(tile.x1 - 1) + kReach),
            high_y = set(static_cast<float>(tile.y1 - 1) + kReach);
    const F per_x = pixels_per_tangent_x(view), per_y = pixels_per_tangent_y(view);
    const F middle_x = set(0.5f * static_cast<float>(view.width) - view.shift.x),
            middle_y = set(0.5f * static_cast<float>(view.height) - view.shift.y);
    const float* radii = cut.radii + cut.first_radius[block];
    size_t count = 0;
    for (uint32_t i = 0; i < from.count; i += static_cast<uint32_t>(hn::Lanes(df))) {
        const Packed packed = load_packed(cut.pool + from.first + i);
        Discs discs;
        Mask near = place_discs(view, packed, origin, size, hn::LoadU(df, radii + i), discs);
        const F inverse = orthographic(view) ? set(1.0f) : over(set(1.0f), discs.centre.z);
        const F x = add(mul(mul(discs.centre.x, inverse), per_x), middle_x),
                y = add(mul(mul(discs.centre.y, inverse), per_y), middle_y);
        const Mask inside = hn::And(hn::And(hn::Gt(x, low_x), hn::Lt(x, high_x)),
                                    hn::And(hn::Gt(y, low_y), hn::Lt(y, high_y)));
        near = hn::And(near, hn::Or(inside, hn::Not(are_small(view, discs))));
        const size_t more = hn::CountTrue(df, near);
        if (more == 0) continue;
        const auto words = hn::RebindMask(du, near);
        const auto keep = [&](F value, float* to) { hn::StoreU(hn::Compress(value, near), df, to + count); };
        const auto keep_words = [&](U value, uint32_t* to) {
            hn::StoreU(hn::Compress(value, words), du, to + count);
        };
        keep(discs.centre.x, found.x);
        keep(discs.centre.y, found.y);
        keep(discs.centre.z, found.z);
        keep(discs.radius, found.radius);
        keep_words(packed.b, found.b);
        keep_words(packed.c, found.c);
        keep_words(packed.d, found.d);
        keep_words(hn::Iota(du, block * kBlockSurfels + i), found.id);
        count += more;
    }
    found.size = item.size;
    found.count = count;
}

/// Loads some of the discs, computes what is missing, and returns which of them are seen.
HWY_INLINE Mask load_discs(const BlockDiscs& from, size_t at, const DiscView& view, Discs& discs) {
    const Floats df;
    discs.centre = {hn::LoadU(df, from.x + at), hn::LoadU(df, from.y + at), hn::LoadU(df, from.z + at)};
    discs.radius = hn::LoadU(df, from.radius + at);
    const U c = hn::LoadU(Words(), from.c + at), d = hn::LoadU(Words(), from.d + at);
    const Mask seen = turn_discs(view, c, d, discs);
    discs.edge = disc_edges(view, hn::LoadU(Words(), from.b + at), c, d, set(from.size));
    return hn::And(seen, hn::FirstN(df, from.count - at));
}

/// Calls draw(lane, disc) for the lanes that are large discs.
template <class Draw>
HWY_INLINE void each_large(uint32_t large, const Discs& discs, const Draw& draw) {
    constexpr int kValues = 12;
    alignas(64) float at[kValues][HWY_MAX_BYTES / 4];
    const F values[kValues] = {discs.centre.x, discs.centre.y, discs.centre.z, discs.normal.x,
                               discs.normal.y, discs.normal.z, discs.radius,   discs.extent,
                               discs.push,     discs.edge.x,   discs.edge.y,   discs.edge.z};
    for (int k = 0; k < kValues; ++k) hn::Store(values[k], Floats(), at[k]);
    for (; large; large &= large - 1) {
        const auto lane = static_cast<size_t>(std::countr_zero(large));
        draw(lane, ViewDisc{{at[0][lane], at[1][lane], at[2][lane]},
                            {at[3][lane], at[4][lane], at[5][lane]},
                            at[6][lane],
                            at[7][lane],
                            at[8][lane],
                            {at[9][lane], at[10][lane], at[11][lane]}});
    }
}

// pixel_tangent() of disc.glsl: for a row of pixels, and for columns.
HWY_INLINE float row_tangent(const DiscView& view, int row) {
    return (2.0f * (static_cast<float>(row) + 0.5f + view.shift.y) / static_cast<float>(view.height) - 1.0f) *
           view.down.w;
}
template <class D>
HWY_INLINE hn::Vec<D> column_tangents(D d, const DiscView& view, int column) {
    const auto one = hn::Set(d, 1.0f);
    const auto middle =
        hn::Add(hn::Add(hn::Iota(d, static_cast<float>(column)), hn::Set(d, 0.5f)), hn::Set(d, view.shift.x));
    const auto share = hn::Div(hn::Mul(hn::Set(d, 2.0f), middle), hn::Set(d, static_cast<float>(view.width)));
    return hn::Mul(hn::Sub(share, one), hn::Set(d, view.right.w));
}

/// Where the rays of some pixels of a row meet the plane of a large disc. See meet_disc().
struct Meeting {
    Row z;          ///< not clamped
    Row distance2;  ///< from the disc's centre, m^2
    Row slope;
    Row beyond;  ///< over 1: beyond the line at which the disc ends (within_edge)
};
HWY_INLINE Meeting meet(const ViewDisc& disc, const DiscView& view, float tangent_y, int column) {
    const RowFloats df;
    const bool flat = orthographic(view);
    const auto row = [&](float v) { return hn::Set(df, v); };
    const Row across = column_tangents(df, view, column);
    const Row ray_x = flat ? hn::Zero(df) : across, ray_y = row(flat ? 0.0f : tangent_y);
    const Row x = hn::Sub(row(disc.centre.x), flat ? across : hn::Zero(df)),
              y = row(disc.centre.y - (flat ? tangent_y : 0.0f)), z = row(disc.centre.z);
    const Row nx = row(disc.normal.x), ny = row(disc.normal.y), nz = row(disc.normal.z);
    Meeting m;
    m.slope = hn::Add(hn::Add(hn::Mul(nx, ray_x), hn::Mul(ny, ray_y)), nz);
    const Row facing = hn::IfThenElse(hn::Lt(hn::Abs(m.slope), row(1e-12f)), row(1e-12f), m.slope);
    m.z = hn::Div(hn::Add(hn::Add(hn::Mul(nx, x), hn::Mul(ny, y)), hn::Mul(nz, z)), facing);
    const Row ox = hn::Sub(hn::Mul(ray_x, m.z), x), oy = hn::Sub(hn::Mul(ray_y, m.z), y),
              oz = hn::Sub(m.z, z);
    m.distance2 = hn::Add(hn::Add(hn::Mul(ox, ox), hn::Mul(oy, oy)), hn::Mul(oz, oz));
    m.beyond = hn::Add(hn::Add(hn::Mul(row(disc.edge.x), ox), hn::Mul(row(disc.edge.y), oy)),
                       hn::Mul(row(disc.edge.z), oz));
    return m;
}
/// Limits depths to those that the disc spans.
HWY_INLINE Row in_disc(const ViewDisc& disc, Row z) {
    const RowFloats df;
    return hn::Min(hn::Max(z, hn::Set(df, disc.centre.z - disc.extent)),
                   hn::Set(df, disc.centre.z + disc.extent));
}

}  // namespace lucarne::gi::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
