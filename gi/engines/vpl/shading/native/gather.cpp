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
    float r2;
    size_t map;  ///< its first texel in the atlas
};

struct GatherJob {
    const GatherInput& input;
    int n;
    std::span<const GatherLight> lights;
    const GatherOutput& output;
};

inline GatherLight gather_light(const VplLight& light, const glm::vec4& eye, size_t map) {
    const MapFrame frame = frame_of(light);
    return {frame.normal,
            frame.tangent,
            frame.bitangent,
            glm::vec3(light.position) - glm::vec3(eye),
            glm::vec3(light.diffuse),
            std::max(light.position.w / kPi, 1e-12f),
            map};
}

}  // namespace lucarne::gi::vpl::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {

/// Some pixels as receivers.
struct Receivers {
    V3 position, normal;
    F radius;
    Mask shown;
};

/// pair_share() of gather.glsl; 0 for lanes that are not `lit`.
HWY_INLINE F pair_share(const GatherLight& light, const V3& offset, const Receivers& to, F distance2,
                        Mask& lit) {
    const F own = hn::Neg(dot(to.normal, offset)), lights = dot(offset, light.normal);
    const F least = hn::Min(own, lights), most = hn::Max(own, lights);
    lit = hn::And(lit, hn::Gt(least, mul(set(kRimPush), to.radius)));
    const F opposite = clamped(hn::Neg(dot(to.normal, light.normal)));
    const F clearance = over(least, to.radius), rise = over(most, hn::Sqrt(distance2));
    const auto ramp = [&](F v, float first, float first_opposite, float width, float width_opposite) {
        const auto mixed = [&](float a, float b) { return add(set(a), mul(set(b - a), opposite)); };
        return clamped(over(sub(v, mixed(first, first_opposite)), mixed(width, width_opposite)));
    };
    return mul(ramp(clearance, kRimPush, 2.0f, 0.6f - kRimPush, 2.0f), ramp(rise, 0.035f, 0.1f, 0.07f, 0.1f));
}

/// disc_form_factor() of gather.glsl.
HWY_INLINE F disc_form_factor(const GatherLight& light, const V3& offset, const Receivers& to, F d2) {
    const F zero = hn::Zero(Floats()), one = set(1.0f), two = set(2.0f), r2 = set(light.r2);
    const F height = dot(offset, light.normal);
    const V3 lateral{sub(offset.x, mul(height, set(light.normal.x))),
                     sub(offset.y, mul(height, set(light.normal.y))),
                     sub(offset.z, mul(height, set(light.normal.z)))};
    const F a2 = dot(lateral, lateral), sum = add(d2, r2);
    const F s = hn::Sqrt(hn::Max(sub(mul(sum, sum), mul(mul(set(4.0f), a2), r2)), set(1e-30f)));
    const F outside = over(mul(mul(mul(two, height), height), r2), mul(s, add(s, sub(d2, r2))));
    const F inside = over(mul(set(0.5f), sub(add(s, r2), d2)), s);
    const F parallel = hn::IfThenElse(hn::Gt(d2, r2), outside, inside);
    const F lateral_share = over(mul(mul(two, height), r2), mul(s, add(sum, s)));
    const auto axis = [&](float n, F l) {
        return sub(mul(hn::Neg(parallel), set(n)), mul(lateral_share, l));
    };
    const V3 flux{axis(light.normal.x, lateral.x), axis(light.normal.y, lateral.y),
                  axis(light.normal.z, lateral.z)};
    const F size = hn::Max(hn::Sqrt(dot(flux, flux)), set(1e-30f));
    const F facing = dot(flux, to.normal), sine = hn::Sqrt(size), cosine = over(facing, size);
    const F above = hn::Max(add(cosine, sine), zero);
    const F partly = over(mul(mul(size, above), above), mul(set(4.0f), sine));
    const F cut = hn::IfThenElse(hn::Ge(cosine, sine), facing, partly);
    const F lossless = hn::Max(over(add(mul(size, size), facing), add(size, one)), zero);
    return mul(set(kPi * 0.5f), add(cut, lossless));
}

/// vpl_sees() of gather.glsl.
HWY_INLINE Mask sees(const GatherInput& input, const GatherLight& light, const V3& offset,
                     const Receivers& to, Mask lit) {
    const Ints di;
    const F zero = hn::Zero(Floats()), one = set(1.0f), half = set(0.5f),
            side = set(static_cast<float>(input.side));
    const auto lift = [&](F along, F normal, float light_normal) {
        return sub(add(along, mul(normal, to.radius)), set(light_normal * light.normal.w));
    };
    const V3 lifted{lift(offset.x, to.normal.x, light.normal.x), lift(offset.y, to.normal.y, light.normal.y),
                    lift(offset.z, to.normal.z, light.normal.z)};
    const V3 receiver{dot(lifted, light.tangent), dot(lifted, light.bitangent), dot(lifted, light.normal)};
    const V3 normal{dot(to.normal, light.tangent), dot(to.normal, light.bitangent),
                    dot(to.normal, light.normal)};
    const F scale = over(one, add(hn::Sqrt(dot(receiver, receiver)), receiver.z));
    const auto texel = [&](F v) {
        const F at = mul(add(mul(mul(v, scale), half), half), side);
        return to_int(di, hn::IfThenElseZero(lit, hn::Min(hn::Max(at, zero), sub(side, one))));
    };
    const auto column = texel(receiver.x), row = texel(receiver.y);
    const auto index = hn::Add(hn::Mul(row, hn::Set(di, static_cast<int32_t>(input.side))), column);
    const U nearest = hn::BitCast(
        Words(), hn::GatherIndex(di, reinterpret_cast<const int32_t*>(input.atlas) + light.map, index));
    const auto centre = [&](hn::Vec<Ints> at) {
        return sub(over(add(mul(set(2.0f), hn::ConvertTo(Floats(), at)), one), side), one);
    };
    const F u = centre(column), v = centre(row), uv2 = add(mul(u, u), mul(v, v));
    const U distance_bits =
        hn::Or(hn::ShiftLeft<12>(hn::Add(hn::ShiftRight<16>(nearest), word(111u << 11))), word(0x800u));
    const F distance = hn::BitCast(Floats(), distance_bits), along = over(distance, add(one, uv2));
    const V3 ahead{sub(mul(mul(set(2.0f), u), along), receiver.x),
                   sub(mul(mul(set(2.0f), v), along), receiver.y),
                   sub(mul(sub(one, uv2), along), receiver.z)};
    const auto fraction = [&](U bits) {
        const F p = over(sub(to_float(hn::And(bits, word(63))), set(31.5f)), set(31.5f));
        return hn::And(hn::BitCast(Words(), nearest_int(mul(p, set(32767.0f)))), word(0xffffu));
    };
    const V3 blocker =
        decode_octahedral(hn::Or(fraction(nearest), hn::ShiftLeft<16>(fraction(hn::ShiftRight<6>(nearest)))));
    // 2^(code - 11)
    const U exponent = hn::Add(hn::And(hn::ShiftRight<12>(nearest), word(15)), word(127 - 11));
    const F radius = hn::BitCast(Floats(), hn::ShiftLeft<23>(exponent));
    const F error = mul(set(kSheetTolerance), hn::Max(radius, mul(set(input.splat_angle), distance)));
    const F width = mul(set(std::sqrt(8.0f) / static_cast<float>(input.side)), distance);
    const F texels = add(one, hn::Max(dot(normal, blocker), zero));
    Mask seen = hn::Or(hn::Le(receiver.z, zero), hn::RebindMask(Floats(), hn::Eq(nearest, word(kNoTexel))));
    seen = hn::Or(seen, hn::Le(dot(normal, ahead), error));
    seen = hn::Or(seen, hn::Le(dot(blocker, ahead), add(error, mul(texels, width))));
    return hn::And(lit, seen);
}

HWY_INLINE Receivers receivers(const Surfaces& from, hn::Vec<Ints> columns) {
    const auto plane = [&](const std::vector<float>& values) {
        return hn::GatherIndex(Floats(), &values[kBorder], columns);
    };
    return {{plane(from.x), plane(from.y), plane(from.z)},
            {plane(from.nx), plane(from.ny), plane(from.nz)},
            plane(from.radius),
            hn::Gt(plane(from.depth), hn::Zero(Floats()))};
}

/// Adds the light of the VPLs of a tile to the lanes of a mask.
void gather_tile(const GatherJob& job, const Receivers& to, Mask lanes, int tile, V3& sum) {
    const F zero = hn::Zero(Floats());
    for (auto i = static_cast<size_t>(tile); i < job.lights.size(); i += static_cast<size_t>(job.n * job.n)) {
        const GatherLight& light = job.lights[i];
        const V3 offset{sub(to.position.x, set(light.position.x)), sub(to.position.y, set(light.position.y)),
                        sub(to.position.z, set(light.position.z))};
        const F d2 = dot(offset, offset);
        Mask lit = lanes;
        const F share = pair_share(light, offset, to, d2, lit);
        lit = hn::And(lit, hn::Gt(share, zero));
        if (hn::AllFalse(Floats(), lit)) continue;
        lit = sees(job.input, light, offset, to, lit);
        if (hn::AllFalse(Floats(), lit)) continue;
        const F factor = hn::IfThenElseZero(
            lit, over(mul(share, disc_form_factor(light, offset, to, d2)), set(kPi * light.r2)));
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
