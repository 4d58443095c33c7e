#include "gi/engines/vpl/shading/native/gather.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include <glm/geometric.hpp>

#include "gi/engines/vpl/shadow_maps/native/map_frame.h"
#include "gi/shared/brdf.h"
#include "io/core/parallel.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/engines/vpl/shading/native/gather.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/engines/vpl/shading/native/surfaces-inl.h"

#ifndef LUCARNE_NATIVE_GATHER_ONCE
#define LUCARNE_NATIVE_GATHER_ONCE
namespace lucarne::gi::vpl::native {

// As in texel.h.
constexpr uint32_t kNoTexel = UINT32_MAX;

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
    Mask shown;
};

// Divisions and roots take most of the time, so quotients share them. A few products are therefore larger or
// smaller than those of the shader; they stay finite for distances from 1e-7 to 1e9 m.

/// pair_share() of gather.glsl for points that face each other: `own` and `lights` are their heights over
/// each other's planes, `per_distance` is 1 / the distance.
HWY_INLINE F pair_share(const GatherLight& light, const Receivers& to, F own, F lights, F per_distance) {
    const F clearance = mul(hn::Min(own, lights), to.per_radius),
            rise = mul(hn::Max(own, lights), per_distance);
    const F opposite = clamped(hn::Neg(dot(to.normal, light.normal)));
    const auto mixed = [&](float a, float b) { return add(set(a), mul(set(b - a), opposite)); };
    const F widths[] = {mixed(0.6f - kRimPush, 2.0f), mixed(0.07f, 0.1f)};
    const F per_widths = over(set(1.0f), mul(widths[0], widths[1]));
    const F clear = mul(sub(clearance, mixed(kRimPush, 2.0f)), mul(widths[1], per_widths)),
            risen = mul(sub(rise, mixed(0.035f, 0.1f)), mul(widths[0], per_widths));
    return mul(clamped(clear), clamped(risen));
}

/// disc_form_factor() of gather.glsl. `height` is that over the plane of the light, `d2` the squared
/// distance.
HWY_INLINE F disc_form_factor(const GatherLight& light, const V3& offset, const Receivers& to, F height,
                              F d2) {
    const F zero = hn::Zero(Floats()), one = set(1.0f), r2 = set(light.r2);
    const V3 lateral{sub(offset.x, mul(height, set(light.normal.x))),
                     sub(offset.y, mul(height, set(light.normal.y))),
                     sub(offset.z, mul(height, set(light.normal.z)))};
    const F a2 = dot(lateral, lateral), sum = add(d2, r2), apart = sub(d2, r2);
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
    const auto axis = [&](float n, F l) {
        return sub(mul(hn::Neg(parallel), set(n)), mul(lateral_share, l));
    };
    const V3 flux{axis(light.normal.x, lateral.x), axis(light.normal.y, lateral.y),
                  axis(light.normal.z, lateral.z)};
    // cut = size (cosine + sine)^2 / (4 sine) or facing, lossless = (size^2 + facing) / (size + 1), where
    // cosine = facing / size
    const F size = hn::Max(hn::Sqrt(dot(flux, flux)), set(1e-20f)), facing = dot(flux, to.normal);
    const F steep = mul(size, hn::Sqrt(size)), above = hn::Max(add(facing, steep), zero);
    const F four_steep = mul(set(4.0f), steep), more = add(size, one);
    const F per_steep = over(one, mul(four_steep, more));
    const F partly = mul(mul(above, above), mul(more, per_steep));
    const F cut = hn::IfThenElse(hn::Ge(facing, steep), facing, partly);
    const F lossless = hn::Max(mul(add(mul(size, size), facing), mul(four_steep, per_steep)), zero);
    return mul(set(kPi * 0.5f), add(cut, lossless));
}

/// The normals that a map's texels hold, unnormalised: map_normal() of parabolic.glsl.
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
HWY_INLINE Mask sees(const GatherInput& input, const GatherLight& light, const V3& offset,
                     const Receivers& to, Mask lit) {
    const Ints di;
    const auto texels = static_cast<float>(input.side);
    const F zero = hn::Zero(Floats()), one = set(1.0f);
    const auto lift = [&](F along, F normal, float light_normal) {
        return sub(add(along, mul(normal, to.radius)), set(light_normal * light.normal.w));
    };
    const V3 lifted{lift(offset.x, to.normal.x, light.normal.x), lift(offset.y, to.normal.y, light.normal.y),
                    lift(offset.z, to.normal.z, light.normal.z)};
    const V3 receiver{dot(lifted, light.tangent), dot(lifted, light.bitangent), dot(lifted, light.normal)};
    const V3 normal{dot(to.normal, light.tangent), dot(to.normal, light.bitangent),
                    dot(to.normal, light.normal)};
    const F half = set(0.5f * texels);
    const F scale = over(half, add(hn::Sqrt(dot(receiver, receiver)), receiver.z));
    const auto texel = [&](F v) {
        const F at = add(mul(v, scale), half);
        return to_int(di, hn::IfThenElseZero(lit, hn::Min(hn::Max(at, zero), set(texels - 1))));
    };
    const auto column = texel(receiver.x), row = texel(receiver.y);
    const auto index = hn::Add(hn::Mul(row, hn::Set(di, static_cast<int32_t>(input.side))), column);
    const U nearest = hn::BitCast(
        Words(), hn::GatherIndex(di, reinterpret_cast<const int32_t*>(input.atlas) + light.map, index));
    const auto centre = [&](hn::Vec<Ints> at) {
        return add(mul(hn::ConvertTo(Floats(), at), set(2 / texels)), set(1 / texels - 1));
    };
    const F u = centre(column), v = centre(row), uv2 = add(mul(u, u), mul(v, v));
    const U distance_bits =
        hn::Or(hn::ShiftLeft<12>(hn::Add(hn::ShiftRight<16>(nearest), word(111u << 11))), word(0x800u));
    const F distance = hn::BitCast(Floats(), distance_bits), along = over(distance, add(one, uv2));
    const F twice = add(along, along);
    const V3 ahead{sub(mul(u, twice), receiver.x), sub(mul(v, twice), receiver.y),
                   sub(mul(sub(one, uv2), along), receiver.z)};
    const V3 blocker = blocker_normals(nearest);
    const F length = hn::Sqrt(dot(blocker, blocker));
    // 2^(code - 11)
    const U exponent = hn::Add(hn::And(hn::ShiftRight<12>(nearest), word(15)), word(127 - 11));
    const F radius = hn::BitCast(Floats(), hn::ShiftLeft<23>(exponent));
    const F error = mul(set(kSheetTolerance), hn::Max(radius, mul(set(input.splat_angle), distance)));
    const F width = mul(set(std::sqrt(8.0f) / texels), distance);
    // Both sides of the test against the blocker's plane are times the length of its normal.
    const F behind = add(mul(add(error, width), length), mul(width, hn::Max(dot(normal, blocker), zero)));
    Mask seen = hn::Or(hn::Le(receiver.z, zero), hn::RebindMask(Floats(), hn::Eq(nearest, word(kNoTexel))));
    seen = hn::Or(seen, hn::Le(dot(normal, ahead), error));
    seen = hn::Or(seen, hn::Le(dot(blocker, ahead), behind));
    return hn::And(lit, seen);
}

HWY_INLINE Receivers receivers(const Surfaces& from, hn::Vec<Ints> columns) {
    const auto plane = [&](const std::vector<float>& values) {
        return hn::GatherIndex(Floats(), &values[kBorder], columns);
    };
    const F radius = plane(from.radius);
    return {{plane(from.x), plane(from.y), plane(from.z)},
            {plane(from.nx), plane(from.ny), plane(from.nz)},
            radius,
            over(set(1.0f), radius),
            hn::Gt(plane(from.depth), hn::Zero(Floats()))};
}

/// Adds the light of the VPLs of a tile to the lanes of a mask.
void gather_tile(const GatherJob& job, const Receivers& to, Mask lanes, int tile, V3& sum) {
    const F zero = hn::Zero(Floats());
    for (auto i = static_cast<size_t>(tile); i < job.lights.size(); i += static_cast<size_t>(job.n * job.n)) {
        const GatherLight& light = job.lights[i];
        const V3 offset{sub(to.position.x, set(light.position.x)), sub(to.position.y, set(light.position.y)),
                        sub(to.position.z, set(light.position.z))};
        // Most VPLs that a pixel cannot see lie behind it, or it behind them.
        const F own = hn::Neg(dot(to.normal, offset)), height = dot(offset, light.normal);
        Mask lit = hn::And(lanes, hn::Gt(hn::Min(own, height), mul(set(kRimPush), to.radius)));
        if (hn::AllFalse(Floats(), lit)) continue;
        const F d2 = dot(offset, offset);
        const F share = pair_share(light, to, own, height, over(set(1.0f), hn::Sqrt(d2)));
        lit = hn::And(lit, hn::Gt(share, zero));
        if (hn::AllFalse(Floats(), lit)) continue;
        lit = sees(job.input, light, offset, to, lit);
        if (hn::AllFalse(Floats(), lit)) continue;
        const F factor = hn::IfThenElseZero(
            lit, mul(mul(share, disc_form_factor(light, offset, to, height, d2)), set(light.per_area)));
        sum = {add(sum.x, mul(set(light.diffuse.x), factor)), add(sum.y, mul(set(light.diffuse.y), factor)),
               add(sum.z, mul(set(light.diffuse.z), factor))};
    }
}

/// Adds sums to pixels; `pixel` returns that of a lane, or null after the last.
template <class Pixel>
HWY_INLINE void add_light(const GatherJob& job, const V3& sum, const Pixel& pixel) {
    // Each tile alone estimates the whole light.
    const F tiles = set(static_cast<float>(job.n * job.n));
    alignas(64) float lanes[3][kLanes];
    hn::Store(mul(sum.x, tiles), Floats(), lanes[0]);
    hn::Store(mul(sum.y, tiles), Floats(), lanes[1]);
    hn::Store(mul(sum.z, tiles), Floats(), lanes[2]);
    for (size_t lane = 0; lane < hn::Lanes(Floats()); ++lane)
        if (glm::vec4* light = pixel(lane))
            *light += glm::vec4(lanes[0][lane], lanes[1][lane], lanes[2][lane], 0);
}

/// Shades the pixels of a row with the VPLs of their tiles.
void gather_row(const GatherJob& job, const Surfaces& from, int y) {
    const Ints di;
    const auto width = static_cast<int>(job.input.camera.width);
    const F zero = hn::Zero(Floats());
    const auto columns = hn::Mul(hn::Iota(di, 0), hn::Set(di, job.n));
    glm::vec4* row = job.output.irradiance + static_cast<size_t>(y) * job.input.camera.width;
    for (int tile = 0; tile < std::min(job.n, width); ++tile)
        for (int x = tile; x < width; x += job.n * static_cast<int>(hn::Lanes(Floats()))) {
            const auto index = hn::Add(columns, hn::Set(di, x));
            const Receivers to = receivers(from, hn::Min(index, hn::Set(di, width - 1)));
            const Mask shown = hn::And(to.shown, hn::RebindMask(Floats(), hn::Lt(index, hn::Set(di, width))));
            if (hn::AllFalse(Floats(), shown)) continue;
            V3 sum{zero, zero, zero};
            gather_tile(job, to, shown, y % job.n * job.n + tile, sum);
            add_light(job, sum, [&](size_t lane) {
                const int at = x + job.n * static_cast<int>(lane);
                return at < width ? row + at : nullptr;
            });
        }
}

/// Returns the tiles of which an isolated pixel finds no light, see missing_tiles() and window_tile() in
/// join.glsl.
uint32_t lacking_tiles(const uint32_t* joint, int n, int x, int y) {
    uint32_t lacking = 0;
    for (int i = 0; i < n * n; ++i) {
        if (joint[i >> 3] >> (4 * (i & 7)) & 15) continue;
        const int column = (x + i % n - (n - 1) / 2 + 2 * n) % n, row = (y + i / n - (n - 1) / 2 + 2 * n) % n;
        lacking |= 1u << (row * n + column);
    }
    return lacking;
}

/// Shades the isolated pixels of a row with the VPLs of the tiles that they lack.
void gather_isolated(const GatherJob& job, const Surfaces& from, int y) {
    const uint32_t width = job.input.camera.width, first = static_cast<uint32_t>(y) * width;
    const auto begin = std::ranges::lower_bound(job.output.isolated, first),
               end = std::ranges::lower_bound(job.output.isolated, first + width);
    const F zero = hn::Zero(Floats());
    for (auto at = begin; at < end; at += static_cast<ptrdiff_t>(hn::Lanes(Floats()))) {
        const auto count = std::min(static_cast<ptrdiff_t>(hn::Lanes(Floats())), end - at);
        alignas(64) int32_t columns[kLanes] = {}, lacking[kLanes] = {};
        for (ptrdiff_t lane = 0; lane < count; ++lane) {
            columns[lane] = static_cast<int32_t>(at[lane] - first);
            lacking[lane] = static_cast<int32_t>(
                lacking_tiles(job.output.joints + 2 * size_t{at[lane]}, job.n, columns[lane], y));
        }
        const Receivers to = receivers(from, hn::Load(Ints(), columns));
        const auto tiles = hn::Load(Ints(), lacking);
        V3 sum{zero, zero, zero};
        for (int tile = 0; tile < job.n * job.n; ++tile) {
            const Mask lanes = hn::RebindMask(Floats(), hn::TestBit(tiles, hn::Set(Ints(), 1 << tile)));
            if (!hn::AllFalse(Floats(), lanes)) gather_tile(job, to, lanes, tile, sum);
        }
        add_light(job, sum, [&](size_t lane) {
            return static_cast<ptrdiff_t>(lane) < count
                       ? job.output.own_irradiance + at[static_cast<ptrdiff_t>(lane)]
                       : nullptr;
        });
    }
}

void GatherRows(const GatherJob& job, int first, int end) {
    Surfaces surfaces(job.input.camera.width, 1);
    for (int y = first; y < end; ++y) {
        read_row(job.input.camera, job.input.texels, y, 0, surfaces);
        gather_row(job, surfaces, y);
        if (job.n > 1) gather_isolated(job, surfaces, y);
    }
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
    const GatherJob job{input, static_cast<int>(n), lights, output};
    parallel_ranges(input.camera.height, 8, [&](size_t first, size_t end) {
        HWY_DYNAMIC_DISPATCH(GatherRows)(job, static_cast<int>(first), static_cast<int>(end));
    });
}

}  // namespace lucarne::gi::vpl::native
#endif
