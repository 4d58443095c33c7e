#include "gi/engines/vpl/shading/native/merge.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <vector>

#include "gi/engines/vpl/shading/native/surfaces.h"
#include "gi/engines/vpl/shading/native/window.h"
#include "gi/native/reflectance.h"
#include "io/core/parallel.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/engines/vpl/shading/native/merge.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/engines/vpl/shading/native/history-inl.h"

#ifndef LUCARNE_NATIVE_MERGE_ONCE
#define LUCARNE_NATIVE_MERGE_ONCE
namespace lucarne::gi::vpl::native {

constexpr int kMergeBand = 32;  ///< rows that a thread takes at a time

/// A candidate of a tile: its offset in planes of irradiance.
struct MergeCandidate {
    ptrdiff_t offset;
    uint32_t bit;
    float weight;
};
struct MergeTile {
    std::array<MergeCandidate, 4> candidates;
    int count;
    uint32_t word, all;  ///< word of the joint and the bits of all candidates
    float per_weight;    ///< 1 / the sum of the weights of all candidates
};

/// Planes of the irradiance of some rows, 0 outside the picture.
struct IrradiancePlanes {
    size_t stride;
    std::array<std::vector<float>, 3> channels;
    IrradiancePlanes(size_t width, size_t rows) : stride(width + 2 * kBorder) {
        for (auto& channel : channels) channel.resize(stride * rows, 0.0f);
    }
};

struct MergeJob {
    const MergeInput& input;
    int n;
    std::span<const MergeTile> tiles;
    const gi::native::DiffuseTables& tables;
    const MergeHistory* history;
    glm::vec4* radiance;
};

inline std::vector<MergeTile> merge_tiles(int n, size_t stride) {
    const auto all = candidates(n);
    const auto of_tile = static_cast<size_t>(candidates_of_tile(n));
    std::vector<MergeTile> tiles;
    for (size_t first = 0; first < all.size(); first += of_tile) {
        MergeTile tile{{}, static_cast<int>(of_tile), all[first].word, 0, 0};
        float weights = 0;
        for (size_t j = 0; j < of_tile; ++j) {
            const Candidate& from = all[first + j];
            tile.candidates[j] = {from.dy * static_cast<ptrdiff_t>(stride) + from.dx, from.bit, from.weight};
            tile.all |= from.bit;
            weights += from.weight;
        }
        tile.per_weight = 1 / weights;
        tiles.push_back(tile);
    }
    return tiles;
}

}  // namespace lucarne::gi::vpl::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::vpl::native::HWY_NAMESPACE {

/// Splits a row of irradiance into planes.
void read_irradiance(const glm::vec4* from, int width, size_t row, IrradiancePlanes& out) {
    const Floats df;
    for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(df))) {
        V3 light;
        F unused;
        load_vec4(from + x, width - x, light, unused);
        const size_t at = row * out.stride + kBorder + static_cast<size_t>(x);
        hn::StoreU(light.x, df, &out.channels[0][at]);
        hn::StoreU(light.y, df, &out.channels[1][at]);
        hn::StoreU(light.z, df, &out.channels[2][at]);
    }
}

/// Returns the mean irradiance of the tiles of some pixels. `at` is the place of the first in the planes.
HWY_INLINE V3 mean_of_tiles(const MergeJob& job, const IrradiancePlanes& from, size_t at, const U joint[2],
                            V3 own) {
    const Floats df;
    const Words du;
    const F zero = hn::Zero(df), one = set(1.0f);
    const float *red = from.channels[0].data() + at, *green = from.channels[1].data() + at,
                *blue = from.channels[2].data() + at;
    F found = zero;
    for (const MergeTile& tile : job.tiles) {
        const U bits = hn::And(joint[tile.word], word(tile.all));
        V3 light{zero, zero, zero};
        F per_weight = set(tile.per_weight);
        Mask any = hn::RebindMask(df, hn::Ne(bits, hn::Zero(du)));
        if (hn::AllTrue(du, hn::Eq(bits, word(tile.all)))) {
            for (int j = 0; j < tile.count; ++j) {
                const MergeCandidate& candidate = tile.candidates[static_cast<size_t>(j)];
                const F weight = set(candidate.weight);
                light = {add(light.x, mul(weight, hn::LoadU(df, red + candidate.offset))),
                         add(light.y, mul(weight, hn::LoadU(df, green + candidate.offset))),
                         add(light.z, mul(weight, hn::LoadU(df, blue + candidate.offset)))};
            }
        } else {
            if (hn::AllFalse(df, any)) continue;
            F weights = zero;
            for (int j = 0; j < tile.count; ++j) {
                const MergeCandidate& candidate = tile.candidates[static_cast<size_t>(j)];
                const Mask counts = hn::RebindMask(df, hn::TestBit(bits, word(candidate.bit)));
                const F weight = set(candidate.weight);
                const auto weighed = [&](const float* plane) {
                    return hn::IfThenElseZero(counts, mul(weight, hn::LoadU(df, plane + candidate.offset)));
                };
                weights = add(weights, hn::IfThenElseZero(counts, weight));
                light = {add(light.x, weighed(red)), add(light.y, weighed(green)),
                         add(light.z, weighed(blue))};
            }
            per_weight = hn::IfThenElseZero(any, over(one, weights));
        }
        found = add(found, hn::IfThenElseZero(any, one));
        own = {add(own.x, mul(light.x, per_weight)), add(own.y, mul(light.y, per_weight)),
               add(own.z, mul(light.z, per_weight))};
    }
    // An isolated pixel has the light of all tiles, tiles_lacking() in join.glsl.
    const F tiles = set(static_cast<float>(job.n * job.n));
    const F count = hn::IfThenElse(hn::Lt(add(found, found), tiles), tiles, found);
    return scaled(own, over(one, count));
}

/// Writes the light of row y of the picture; `from` holds its irradiance as row `row`.
void merge_row(const MergeJob& job, const IrradiancePlanes& from, size_t row, int y) {
    const Floats df;
    const Words du;
    const CameraView& camera = job.input.camera;
    const auto width = static_cast<int>(camera.width), lanes = static_cast<int>(hn::Lanes(df));
    const F zero = hn::Zero(df), one = set(1.0f);
    for (int x = 0; x < width; x += lanes) {
        const int count = std::min(lanes, width - x);
        const size_t pixel = static_cast<size_t>(y) * camera.width + static_cast<size_t>(x),
                     at = kBorder + static_cast<size_t>(x);
        const TexelWords texel = load_texels(job.input.texels + pixel, count);
        const F depth = hn::BitCast(df, texel.depth);
        const Mask shown = hn::Gt(depth, zero);
        alignas(64) uint32_t joints[2 * kLanes] = {};
        std::memcpy(joints, job.input.joints + 2 * pixel, 2 * sizeof(uint32_t) * static_cast<size_t>(count));
        U joint[2];
        hn::LoadInterleaved2(du, joints, joint[0], joint[1]);
        V3 light;
        F unused;
        load_vec4(job.input.own_irradiance + pixel, count, light, unused);
        light = mean_of_tiles(job, from, row * from.stride + at, joint, light);
        if (job.history) {
            const V3 position = view_offset(camera, view_columns(camera, x), view_row(camera, y), depth);
            const V3 normal = decode_octahedral(texel.normal);
            const KnownLight known = with_history(*job.history, camera, position, normal, shown, light);
            light = known.irradiance;
            store_vec4(choose(shown, light, {zero, zero, zero}), hn::IfThenElseZero(shown, known.frames),
                       count, job.history->next_light + pixel);
            const auto stored = hn::RebindMask(du, shown);
            alignas(64) uint32_t words[2 * kLanes];
            hn::StoreInterleaved2(hn::IfThenElseZero(stored, texel.depth),
                                  hn::IfThenElseZero(stored, texel.normal), du, words);
            std::memcpy(job.history->next_surfaces + 2 * pixel, words,
                        2 * sizeof(uint32_t) * static_cast<size_t>(count));
        }
        const V3 kd = scaled(diffuse_reflectance(job.tables, texel.albedo, texel.material), set(1 / kPi));
        const V3 reflected{mul(light.x, kd.x), mul(light.y, kd.y), mul(light.z, kd.z)};
        store_vec4(choose(shown, reflected, {zero, zero, zero}), one, count, job.radiance + pixel);
    }
}

void MergeBand(const MergeJob& job, int first, int end) {
    const CameraView& camera = job.input.camera;
    const auto width = static_cast<int>(camera.width), height = static_cast<int>(camera.height);
    IrradiancePlanes planes(camera.width, static_cast<size_t>(kMergeBand + 2 * job.n));
    const auto row_of = [&](int y) { return static_cast<size_t>(y - first + job.n); };
    for (int y = std::max(0, first - job.n); y < std::min(height, end + job.n); ++y)
        read_irradiance(job.input.irradiance + static_cast<size_t>(y) * camera.width, width, row_of(y),
                        planes);
    for (int y = first; y < end; ++y) merge_row(job, planes, row_of(y), y);
}

}  // namespace lucarne::gi::vpl::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::vpl::native {

HWY_EXPORT(MergeBand);
void merge(const MergeInput& input, uint32_t n, const MergeHistory* history, glm::vec4* radiance) {
    const auto tiles = merge_tiles(static_cast<int>(n), input.camera.width + 2 * kBorder);
    const gi::native::DiffuseTables tables(input.materials);
    const MergeJob job{input, static_cast<int>(n), tiles, tables, history, radiance};
    parallel_ranges(input.camera.height, kMergeBand, [&](size_t first, size_t end) {
        HWY_DYNAMIC_DISPATCH(MergeBand)(job, static_cast<int>(first), static_cast<int>(end));
    });
}

}  // namespace lucarne::gi::vpl::native
#endif
