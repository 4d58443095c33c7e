#include "gi/engines/vpl/sky/native/shade.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "io/core/parallel.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/engines/vpl/sky/native/shade.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/engines/vpl/shading/native/interleaved-inl.h"
#include "gi/engines/vpl/shadow_maps/native/texel-inl.h"

#ifndef LUCARNE_NATIVE_SKY_SHADE_ONCE
#define LUCARNE_NATIVE_SKY_SHADE_ONCE
namespace lucarne::gi::vpl::native {

/// A map for points relative to the camera.
struct SkyMapAt {
    glm::vec4 across, down, away, irradiance;
    glm::vec3 column, row;          ///< the sides of a texel, m
    float least_lift;               ///< m
    uint32_t columns, rows, first;  ///< of its texels
};
inline SkyMapAt map_at(const SkyMap& map, const glm::vec3& eye) {
    const auto moved = [&](const glm::vec4& v) {
        return glm::vec4(glm::vec3(v), v.w + glm::dot(glm::vec3(v), eye));
    };
    const glm::vec3 across(map.across), down(map.down);
    return {moved(map.across),
            moved(map.down),
            moved(map.away),
            map.irradiance,
            across / glm::dot(across, across),
            down / glm::dot(down, down),
            sky_lift(map, 0.0f),
            map.columns,
            map.rows,
            map.first};
}

struct SkyShadeJob {
    const SkyShading& input;
    std::span<const SkyMapAt> maps;
};

}  // namespace lucarne::gi::vpl::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {

struct SkyReceivers {
    V3 position, normal;  ///< relative to the origin of the view
    V3 nearer;            ///< the way to the viewer, as long as the radius
    F radius;
};

/// map_normal() of texel.h.
HWY_INLINE V3 map_normals(U texels) {
    const auto fraction = [](U bits) {
        const F p = over(sub(to_float(hn::And(bits, word(63))), set(31.5f)), set(31.5f));
        return hn::BitCast(Words(), nearest_int(mul(p, set(32767.0f))));
    };
    return decode_octahedral(hn::Or(hn::And(fraction(texels), word(0xffffu)),
                                    hn::ShiftLeft<16>(fraction(hn::ShiftRight<6>(texels)))));
}

/// Adds the irradiance by a map, as gather() in shading/gather_sky.glsl.
HWY_INLINE void add_map(const SkyShadeJob& job, const SkyMapAt& map, const SkyReceivers& to, Mask lanes,
                        V3& sum) {
    const Floats df;
    const Ints di;
    const F zero = hn::Zero(df), half = set(0.5f);
    const F cosine = hn::Neg(dot(to.normal, map.away));
    const Mask lit = hn::And(lanes, hn::Gt(cosine, zero));
    if (hn::AllFalse(df, lit)) return;
    const V3 off = scaled(to.normal, hn::Max(to.radius, set(map.least_lift)));
    const V3 moved{add(off.x, to.nearer.x), add(off.y, to.nearer.y), add(off.z, to.nearer.z)};  // sky_moved()
    const V3 lifted{add(to.position.x, moved.x), add(to.position.y, moved.y), add(to.position.z, moved.z)};
    const auto along = [&](const glm::vec4& row) { return add(dot(lifted, row), set(row.w)); };
    const F lift = dot(to.normal, moved);
    const F x = along(map.across), y = along(map.down), depth = along(map.away);
    const auto corner = [&](F place, uint32_t count) {
        const F last = set(static_cast<float>(count - 1));
        return hn::IfThenElseZero(lit, hn::Min(hn::Max(hn::Floor(place), zero), last));
    };
    const auto neighbour = [&](F from, F place, uint32_t count) {  // sky_neighbour()
        const F step = hn::IfThenElse(hn::Lt(sub(place, from), half), set(-1.0f), set(1.0f));
        const F last = set(static_cast<float>(count - 1));
        return hn::IfThenElseZero(lit, hn::Min(hn::Max(add(from, step), zero), last));
    };
    const auto columns = hn::Set(di, static_cast<int32_t>(map.columns));
    const uint32_t* texels = job.input.texels + map.first;
    struct Verdict {
        Mask unsure, blocks;
    };
    const auto verdict = [&](F column, F row) {  // sky_verdict()
        const auto at = hn::Add(hn::Mul(to_int(di, row), columns), to_int(di, column));
        const U texel =
            hn::BitCast(Words(), hn::GatherIndex(di, reinterpret_cast<const int32_t*>(texels), at));
        const F dx = sub(add(column, half), x), dy = sub(add(row, half), y);
        const F dz =
            sub(mul(add(to_float(hn::ShiftRight<16>(texel)), half), set(job.input.depth_step)), depth);
        const auto axis = [&](float right, float down, float away) {
            return add(add(mul(dx, set(right)), mul(dy, set(down))), mul(dz, set(away)));
        };
        const V3 offset{axis(map.column.x, map.row.x, map.away.x), axis(map.column.y, map.row.y, map.away.y),
                        axis(map.column.z, map.row.z, map.away.z)};
        const V3 facing = map_normals(texel);
        const F height = add(dot(to.normal, offset), lift), front = dot(facing, offset);
        const F both = dot(to.normal, facing);
        const F error = add(mul(set(kRimPush), hn::Max(to.radius, map_radii(Words(), texel))),
                            mul(set(kSkyNormalError), hn::Sqrt(dot(offset, offset))));
        const Mask any = hn::RebindMask(df, hn::Ne(texel, word(kNothing)));
        const Mask above = hn::Gt(height, to.radius), before = hn::Lt(front, hn::Neg(error));
        const Mask blocks = hn::And(any, hn::AndNot(before, above));
        const Mask beside = hn::And(hn::Gt(height, hn::Neg(to.radius)), hn::Lt(both, set(kSkyOwn)));
        return Verdict{hn::Or(hn::Not(any), hn::AndNot(above, beside)), blocks};
    };
    const F column = corner(x, map.columns), row = corner(y, map.rows);
    const Verdict own = verdict(column, row);
    Mask blocks = own.blocks;
    const auto look = [&](F at_column, F at_row) {
        const Mask asked = hn::And(hn::AndNot(blocks, lit), own.unsure);
        if (!hn::AllFalse(df, asked))
            blocks = hn::Or(blocks, hn::And(asked, verdict(at_column, at_row).blocks));
    };
    const F other_column = neighbour(column, x, map.columns), other_row = neighbour(row, y, map.rows);
    look(other_column, row);
    look(column, other_row);
    look(other_column, other_row);
    const F seen = hn::IfThenElseZero(hn::AndNot(blocks, lit), cosine);
    sum = {add(sum.x, mul(seen, set(map.irradiance.x))), add(sum.y, mul(seen, set(map.irradiance.y))),
           add(sum.z, mul(seen, set(map.irradiance.z)))};
}

/// The maps as Batch takes them.
struct SkyLights {
    static constexpr size_t kTogether = 2;  ///< maps are small: 16 took a tenth longer
    using Receivers = SkyReceivers;
    const SkyShadeJob& job;

    size_t count() const { return job.maps.size(); }
    Receivers receivers(const V3& position, const V3& normal, F radius) const {
        const glm::vec3 back(-glm::vec3(job.input.camera.forward));
        const V3 to_viewer = is_parallel(job.input.camera) ? V3{set(back.x), set(back.y), set(back.z)}
                                                           : normalized(scaled(position, set(-1.0f)));
        return {position, normal, scaled(to_viewer, radius), radius};
    }
    HWY_INLINE void add(size_t number, const Receivers& to, Mask lanes, V3& sum) const {
        add_map(job, job.maps[number], to, lanes, sum);
    }
};

void ShadeSkyRows(const InterleavedPicture& picture, const SkyShadeJob& job, int first, int end) {
    light_rows(picture, SkyLights{job}, first, end);
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::vpl::native {

HWY_EXPORT(ShadeSkyRows);
void shade_sky(const SkyShading& input, uint32_t n, const GatherOutput& output) {
    std::vector<SkyMapAt> maps;
    for (const SkyMap& map : input.maps) maps.push_back(map_at(map, glm::vec3(input.camera.origin)));
    const SkyShadeJob job{input, maps};
    const InterleavedPicture picture{input.camera, input.pixels, static_cast<int>(n), output};
    parallel_ranges(input.camera.height, 32, [&](size_t first, size_t end) {
        HWY_DYNAMIC_DISPATCH(ShadeSkyRows)(picture, job, static_cast<int>(first), static_cast<int>(end));
    });
}

}  // namespace lucarne::gi::vpl::native
#endif
