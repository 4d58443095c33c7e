#include "gi/engines/vpl/shading/native/gather.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include <glm/geometric.hpp>

#include "gi/engines/vpl/shading/native/window.h"
#include "gi/engines/vpl/shading/separation.h"
#include "gi/engines/vpl/shadow_maps/native/map_frame.h"
#include "gi/engines/vpl/shadow_maps/splats.h"
#include "gi/shared/brdf.h"
#include "io/core/parallel.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/engines/vpl/shading/native/gather.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/engines/vpl/shading/native/surfaces-inl.h"
#include "gi/engines/vpl/shadow_maps/native/texel-inl.h"

#ifndef LUCARNE_NATIVE_GATHER_ONCE
#define LUCARNE_NATIVE_GATHER_ONCE
namespace lucarne::gi::vpl::native {

/// A VPL with the frame of its map.
struct GatherLight {
    glm::vec4 normal, tangent, bitangent;
    glm::vec3 position;  ///< relative to the camera
    glm::vec3 diffuse;
    float r2, per_area;  ///< squared radius of the footprint, and 1 / its area
    size_t map;          ///< its first texel in the atlas
};

struct GatherJob {
    const GatherInput& input;
    int n;
    std::span<const GatherLight> lights;
    const GatherOutput& output;
    float texels, texel, width;  ///< of a map: along a side; a texel's side; its angle
};

inline GatherLight gather_light(const VplLight& light, const glm::vec4& eye, size_t map) {
    const MapFrame frame = frame_of(light);
    const float r2 = std::max(light.position.w / kPi, 1e-12f);
    return {frame.normal,
            frame.tangent,
            frame.bitangent,
            glm::vec3(light.position) - glm::vec3(eye),
            glm::vec3(light.diffuse),
            r2,
            1 / (kPi * r2),
            map};
}

}  // namespace lucarne::gi::vpl::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {

/// Some pixels as receivers.
struct Receivers {
    V3 position, normal;
    F radius, per_radius;
};

// Divisions are slow, so quotients share them. The common denominators are finite for distances up to 1e9 m.

/// A VPL and some pixels.
struct Pair {
    V3 offset;      ///< from the VPL
    F d2;           ///< its square
    F own, height;  ///< heights of the VPL over the planes of the pixels, and of them over its plane
    F cosine;       ///< between the normals
};
HWY_INLINE Pair pair_of(const GatherLight& light, const Receivers& to) {
    const V3 offset{sub(to.position.x, set(light.position.x)), sub(to.position.y, set(light.position.y)),
                    sub(to.position.z, set(light.position.z))};
    return {offset, dot(offset, offset), hn::Neg(dot(to.normal, offset)), dot(offset, light.normal),
            dot(to.normal, light.normal)};
}

/// pair_share() of gather.glsl, with separate_share(), for points that face each other.
HWY_INLINE F pair_share(const Receivers& to, const Pair& pair) {
    const F clearance = mul(hn::Min(pair.own, pair.height), to.per_radius),
            most = hn::Max(pair.own, pair.height), distance = hn::Sqrt(pair.d2);
    const F opposite = clamped(hn::Neg(pair.cosine));
    const auto mixed = [&](float a, float b) { return add(set(a), mul(set(b - a), opposite)); };
    const F width = mixed(kClearRange, kClearRangeFacing),
            rise_width = mul(mixed(kRiseRange, kRiseRangeFacing), distance);
    const F per_widths = over(set(1.0f), mul(width, rise_width));
    const F clear = mul(sub(clearance, mixed(kClear, kClearFacing)), mul(rise_width, per_widths)),
            risen = mul(sub(most, mul(mixed(kRise, kRiseFacing), distance)), mul(width, per_widths));
    return mul(clamped(clear), clamped(risen));
}

/// disc_form_factor() of gather.glsl. The normal of the light is perpendicular to `lateral`, so the flux, a
/// sum of both, needs no vectors.
HWY_INLINE F disc_form_factor(const GatherLight& light, const Pair& pair) {
    const F zero = hn::Zero(Floats()), one = set(1.0f), r2 = set(light.r2), height = pair.height;
    const F a2 = sub(pair.d2, mul(height, height)), sum = add(pair.d2, r2), apart = sub(pair.d2, r2);
    const F s = hn::Sqrt(hn::Max(sub(mul(sum, sum), mul(a2, set(4 * light.r2))), set(1e-30f)));
    // parallel = 2 height^2 r2 / (s (s + d2 - r2)) outside, (s + r2 - d2) / (2 s) inside;
    // lateral_share = 2 height r2 / (s (d2 + r2 + s))
    const Mask outside = hn::Gt(apart, zero);
    const F beyond = hn::IfThenElse(outside, add(s, apart), one), around = add(sum, s);
    const F per_s = over(one, s), per_both = mul(over(one, mul(beyond, around)), per_s);
    const F reach = mul(height, set(2 * light.r2));
    const F parallel = hn::IfThenElse(outside, mul(mul(reach, height), mul(around, per_both)),
                                      mul(mul(set(0.5f), sub(s, apart)), per_s));
    const F lateral_share = mul(reach, mul(beyond, per_both));
    // The lateral part of the offset leads away from the light; `toward` is its negative dot product with the
    // normal of the receiver.
    const F toward = add(pair.own, mul(height, pair.cosine));
    const F facing = sub(mul(lateral_share, toward), mul(parallel, pair.cosine));
    const F size2 = add(mul(parallel, parallel), mul(mul(lateral_share, lateral_share), a2));
    // cut = size (cosine + sine)^2 / (4 sine) or facing, lossless = (size^2 + facing) / (size + 1), where
    // cosine = facing / size
    const F size = hn::Sqrt(hn::Max(size2, set(1e-36f))), steep = mul(size, hn::Sqrt(size));
    const F above = hn::Max(add(facing, steep), zero);
    const F four_steep = mul(set(4.0f), steep), more = add(size, one);
    const F per_steep = over(one, mul(four_steep, more));
    const F partly = mul(mul(above, above), mul(more, per_steep));
    const F cut = hn::IfThenElse(hn::Ge(facing, steep), facing, partly);
    const F lossless = hn::Max(mul(add(mul(size, size), facing), mul(four_steep, per_steep)), zero);
    return mul(set(kPi * 0.5f), add(cut, lossless));
}

/// The normals that a map's texels hold, unnormalised: map_normal() of texel.h without its rounding to 16
/// bits.
HWY_INLINE V3 blocker_normals(U texel) {
    const auto fraction = [&](U bits) {
        return sub(mul(to_float(hn::And(bits, word(63))), set(2 / 63.0f)), set(1.0f));
    };
    const F x = fraction(texel), y = fraction(hn::ShiftRight<6>(texel));
    const F z = sub(sub(set(1.0f), hn::Abs(x)), hn::Abs(y));
    const F fold = hn::Max(hn::Neg(z), hn::Zero(Floats()));
    return {sub(x, hn::CopySign(fold, x)), sub(y, hn::CopySign(fold, y)), z};
}

/// vpl_sees() of gather.glsl.
HWY_INLINE Mask sees(const GatherJob& job, const GatherLight& light, const Pair& pair, const Receivers& to,
                     Mask lit) {
    const Ints di;
    const GatherInput& input = job.input;
    const F zero = hn::Zero(Floats()), one = set(1.0f);
    // In the frame of the map: the normal, and the point a radius above its surface.
    const V3 normal{dot(to.normal, light.tangent), dot(to.normal, light.bitangent), pair.cosine};
    const V3 receiver{add(dot(pair.offset, light.tangent), mul(normal.x, to.radius)),
                      add(dot(pair.offset, light.bitangent), mul(normal.y, to.radius)),
                      sub(add(pair.height, mul(normal.z, to.radius)), set(light.normal.w))};
    const F half = set(0.5f * job.texels);
    const F scale = over(half, add(hn::Sqrt(dot(receiver, receiver)), receiver.z));
    const auto texel = [&](F v) {
        const F at = add(mul(v, scale), half);
        return to_int(di, hn::IfThenElseZero(lit, hn::Min(hn::Max(at, zero), set(job.texels - 1))));
    };
    const auto column = texel(receiver.x), row = texel(receiver.y);
    const auto index = hn::Add(hn::Mul(row, hn::Set(di, static_cast<int32_t>(input.side))), column);
    const U nearest = hn::BitCast(
        Words(), hn::GatherIndex(di, reinterpret_cast<const int32_t*>(input.atlas) + light.map, index));
    const auto centre = [&](hn::Vec<Ints> at) {
        return add(mul(hn::ConvertTo(Floats(), at), set(job.texel)), set(0.5f * job.texel - 1));
    };
    const F u = centre(column), v = centre(row), uv2 = add(mul(u, u), mul(v, v));
    const F distance = map_distances(Words(), nearest), along = over(distance, add(one, uv2));
    const F twice = add(along, along);
    const V3 ahead{sub(mul(u, twice), receiver.x), sub(mul(v, twice), receiver.y),
                   sub(mul(sub(one, uv2), along), receiver.z)};
    const V3 blocker = blocker_normals(nearest);
    const F length = hn::Sqrt(dot(blocker, blocker));
    const F radius = map_radii(Words(), nearest);
    const F error = mul(set(kSheetTolerance), hn::Max(radius, mul(set(input.splat_angle), distance)));
    const F width = mul(set(job.width), distance);
    // Both sides of the test against the blocker's plane are times the length of its normal.
    const F behind = add(mul(add(error, width), length), mul(width, hn::Max(dot(normal, blocker), zero)));
    Mask seen = hn::Or(hn::Le(receiver.z, zero), hn::RebindMask(Floats(), hn::Eq(nearest, word(kNothing))));
    seen = hn::Or(seen, hn::Le(dot(normal, ahead), error));
    seen = hn::Or(seen, hn::Le(dot(blocker, ahead), behind));
    return hn::And(lit, seen);
}

/// Adds the light of a VPL to the lanes of a mask.
HWY_INLINE void add_vpl(const GatherJob& job, const GatherLight& light, const Receivers& to, Mask lanes,
                        V3& sum) {
    const Pair pair = pair_of(light, to);
    // Most VPLs that a pixel cannot see lie behind it, or it behind them.
    Mask lit = hn::And(lanes, hn::Gt(hn::Min(pair.own, pair.height), mul(set(kRimPush), to.radius)));
    if (hn::AllFalse(Floats(), lit)) return;
    const F share = pair_share(to, pair);
    lit = hn::And(lit, hn::Gt(share, hn::Zero(Floats())));
    if (hn::AllFalse(Floats(), lit)) return;
    lit = sees(job, light, pair, to, lit);
    if (hn::AllFalse(Floats(), lit)) return;
    const F factor =
        hn::IfThenElseZero(lit, mul(mul(share, disc_form_factor(light, pair)), set(light.per_area)));
    sum = {add(sum.x, mul(set(light.diffuse.x), factor)), add(sum.y, mul(set(light.diffuse.y), factor)),
           add(sum.z, mul(set(light.diffuse.z), factor))};
}

/// Shades pixels, some vectors at a time: those of one tile read the same map, which then stays in the cache.
class Batch {
 public:
    /// `surfaces` holds the rows of the picture from `first_row` on.
    Batch(const GatherJob& job, const Surfaces& surfaces, int first_row, glm::vec4* target)
        : job_(job), surfaces_(surfaces), first_row_(first_row), target_(target) {}

    /// Adds the pixels at columns and rows of the picture. Each lane gets the light of the tiles in its mask,
    /// 0 for none.
    void add(hn::Vec<Ints> columns, hn::Vec<Ints> rows, U tiles) {
        const Ints di;
        const auto int_of = [&](size_t v) { return hn::Set(di, static_cast<int32_t>(v)); };
        const auto place = hn::Add(hn::Mul(hn::Sub(rows, hn::Set(di, first_row_)), int_of(surfaces_.stride)),
                                   hn::Add(columns, int_of(kBorder)));
        const auto plane = [&](const std::vector<float>& values) {
            return hn::GatherIndex(Floats(), values.data(), place);
        };
        const Mask shown = hn::Gt(plane(surfaces_.depth), hn::Zero(Floats()));
        tiles = hn::IfThenElseZero(hn::RebindMask(Words(), shown), tiles);
        if (hn::AllTrue(Words(), hn::Eq(tiles, hn::Zero(Words())))) return;
        const F radius = plane(surfaces_.radius), zero = hn::Zero(Floats());
        to_[count_] = {{plane(surfaces_.x), plane(surfaces_.y), plane(surfaces_.z)},
                       {plane(surfaces_.nx), plane(surfaces_.ny), plane(surfaces_.nz)},
                       radius,
                       hn::Div(set(1.0f), radius)};
        tiles_[count_] = tiles;
        pixels_[count_] = hn::Add(hn::Mul(rows, int_of(job_.input.camera.width)), columns);
        sum_[count_] = {zero, zero, zero};
        if (++count_ == kMost) shade();
    }
    /// Shades the pixels that were added last; call once at the end.
    void shade() {
        for (int tile = 0; tile < job_.n * job_.n; ++tile) gather_tile(tile);
        for (size_t i = 0; i < count_; ++i) add_light(i);
        count_ = 0;
    }

 private:
    static constexpr size_t kMost = 16;

    void gather_tile(int tile) {
        Mask lanes[kMost];
        size_t which[kMost], used = 0;
        for (size_t i = 0; i < count_; ++i) {
            lanes[used] = hn::RebindMask(Floats(), hn::TestBit(tiles_[i], word(1u << tile)));
            which[used] = i;
            used += !hn::AllFalse(Floats(), lanes[used]);
        }
        if (!used) return;
        const auto step = static_cast<size_t>(job_.n * job_.n);
        for (auto light = static_cast<size_t>(tile); light < job_.lights.size(); light += step)
            for (size_t i = 0; i < used; ++i)
                add_vpl(job_, job_.lights[light], to_[which[i]], lanes[i], sum_[which[i]]);
    }
    void add_light(size_t i) {
        // Each tile alone estimates the whole light.
        const F tiles = set(static_cast<float>(job_.n * job_.n));
        alignas(64) float lanes[3][kLanes];
        alignas(64) int32_t pixels[kLanes];
        alignas(64) uint32_t masks[kLanes];
        hn::Store(mul(sum_[i].x, tiles), Floats(), lanes[0]);
        hn::Store(mul(sum_[i].y, tiles), Floats(), lanes[1]);
        hn::Store(mul(sum_[i].z, tiles), Floats(), lanes[2]);
        hn::Store(pixels_[i], Ints(), pixels);
        hn::Store(tiles_[i], Words(), masks);
        for (size_t lane = 0; lane < hn::Lanes(Floats()); ++lane)
            if (masks[lane])
                target_[pixels[lane]] += glm::vec4(lanes[0][lane], lanes[1][lane], lanes[2][lane], 0);
    }

    const GatherJob& job_;
    const Surfaces& surfaces_;
    int first_row_;
    glm::vec4* target_;
    size_t count_ = 0;
    Receivers to_[kMost];
    U tiles_[kMost];
    hn::Vec<Ints> pixels_[kMost];
    V3 sum_[kMost];
};

/// Shades the pixels of some rows with the VPLs of their tiles, tile after tile.
void gather_pixels(const GatherJob& job, int first, int end, Batch& batch) {
    const Ints di;
    const auto width = static_cast<int>(job.input.camera.width);
    const auto columns = hn::Mul(hn::Iota(di, 0), hn::Set(di, job.n));
    const auto last = hn::Set(di, width - 1);
    // Down before across: pixels close to each other read few texels of a map.
    for (int tile = 0; tile < job.n * job.n; ++tile)
        for (int x = tile % job.n; x < width; x += job.n * static_cast<int>(hn::Lanes(Floats())))
            for (int y = first; y < end; ++y) {
                if (y % job.n != tile / job.n) continue;
                const auto column = hn::Add(columns, hn::Set(di, x));
                const auto inside = hn::RebindMask(Words(), hn::Lt(column, hn::Set(di, width)));
                batch.add(hn::Min(column, last), hn::Set(di, y),
                          hn::IfThenElseZero(inside, word(1u << tile)));
            }
}

/// Shades the isolated pixels of some rows with the VPLs of the tiles that they lack.
void gather_isolated(const GatherJob& job, int first, int end, Batch& batch) {
    const uint32_t width = job.input.camera.width;
    const auto begin = std::ranges::lower_bound(job.output.isolated, static_cast<uint32_t>(first) * width),
               stop = std::ranges::lower_bound(job.output.isolated, static_cast<uint32_t>(end) * width);
    const auto lanes = static_cast<ptrdiff_t>(hn::Lanes(Floats()));
    for (auto at = begin; at < stop; at += std::min(lanes, stop - at)) {
        alignas(64) int32_t columns[kLanes] = {}, rows[kLanes];
        alignas(64) uint32_t lacking[kLanes] = {};
        std::ranges::fill(rows, first);
        for (ptrdiff_t lane = 0; lane < std::min(lanes, stop - at); ++lane) {
            columns[lane] = static_cast<int32_t>(at[lane] % width);
            rows[lane] = static_cast<int32_t>(at[lane] / width);
            lacking[lane] =
                lacking_tiles(job.output.joints + 2 * size_t{at[lane]}, job.n, columns[lane], rows[lane]);
        }
        batch.add(hn::Load(Ints(), columns), hn::Load(Ints(), rows), hn::Load(Words(), lacking));
    }
}

void GatherRows(const GatherJob& job, int first, int end) {
    Surfaces surfaces(job.input.camera.width, static_cast<size_t>(end - first));
    for (int y = first; y < end; ++y)
        read_row(job.input.camera, job.input.texels, y, static_cast<size_t>(y - first), surfaces);
    Batch pixels(job, surfaces, first, job.output.irradiance);
    gather_pixels(job, first, end, pixels);
    pixels.shade();
    if (job.n == 1) return;
    Batch isolated(job, surfaces, first, job.output.own_irradiance);
    gather_isolated(job, first, end, isolated);
    isolated.shade();
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::vpl::native {

HWY_EXPORT(GatherRows);
void gather(const GatherInput& input, uint32_t n, const GatherOutput& output) {
    std::vector<GatherLight> lights;
    for (const VplLight& light : input.lights)
        lights.push_back(gather_light(light, input.camera.origin, lights.size() * input.side * input.side));
    const auto texels = static_cast<float>(input.side);
    const GatherJob job{input,      static_cast<int>(n),    lights, output, texels,
                        2 / texels, map_texel_angle(texels)};
    parallel_ranges(input.camera.height, 32, [&](size_t first, size_t end) {
        HWY_DYNAMIC_DISPATCH(GatherRows)(job, static_cast<int>(first), static_cast<int>(end));
    });
}

}  // namespace lucarne::gi::vpl::native
#endif
