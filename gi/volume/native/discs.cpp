#include "gi/volume/native/discs.h"

#include <algorithm>

#include "gi/shared/brdf.h"
#include "gi/volume/blocks.h"
#include "gi/volume/disc_areas.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/volume/native/discs.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/native/vectors-inl.h"

#ifndef LUCARNE_VOLUME_NATIVE_DISCS_ONCE
#define LUCARNE_VOLUME_NATIVE_DISCS_ONCE
namespace lucarne::gi::native {

using volume::DiscBatch, volume::Grid, volume::kBlocksAlong, volume::kTouching, volume::kTouchingBlocks;

/// Discs as they are stored, by component.
struct RawDiscs {
    using Floats = DiscBatch::Floats;
    alignas(64) std::array<Floats, 3> position;
    alignas(64) Floats radius, area;
    alignas(64) std::array<uint32_t, DiscBatch::kMost> normal;
};

}  // namespace lucarne::gi::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::native::HWY_NAMESPACE {

constexpr size_t kDiscLanes = hn::MaxLanes(Floats());
static_assert(DiscBatch::kMost % kDiscLanes == 0);

/// Arc cosine of -1 to 1, within 3e-7 (S. L. Moshier, Cephes, asinf.c).
HWY_INLINE F arc_cosine(F v) {
    const F size = hn::Abs(v), half = set(.5f);
    const Mask outer = hn::Gt(size, half);
    const F square = hn::IfThenElse(outer, mul(half, sub(set(1.0f), size)), mul(size, size));
    const F root = hn::IfThenElse(outer, hn::Sqrt(square), size);
    F sum = set(4.2163199048e-2f);
    for (const float next : {2.4181311049e-2f, 4.5470025998e-2f, 7.4953002686e-2f, 1.6666752422e-1f})
        sum = add(mul(sum, square), set(next));
    const F sine = add(root, mul(mul(root, square), sum));  // of the size's arc, or half its complement
    const F positive = hn::IfThenElse(outer, add(sine, sine), sub(set(kPi / 2), sine));
    return hn::IfThenElse(hn::Lt(v, hn::Zero(Floats())), sub(set(kPi), positive), positive);
}

/// volume::disc_share().
HWY_INLINE F share_before(F distance) {
    const F one = set(1.0f), d = hn::Max(hn::Min(distance, one), set(-1.0f));
    const F segment = sub(arc_cosine(d), mul(d, hn::Sqrt(sub(one, mul(d, d)))));
    return clamped(sub(one, mul(segment, set(1 / kPi))));
}

/// volume::gap_between().
HWY_INLINE hn::Vec<Ints> gap_of(F radius, F area) {
    const F along =
        sub(hn::Sqrt(hn::Max(add(mul(set(4 - kPi), mul(radius, radius)), mul(set(volume::kRarity), area)),
                             hn::Zero(Floats()))),
            add(radius, radius));
    const F blocks = hn::Ceil(mul(along, set(float{kBlocksAlong})));
    return to_int(Ints(), hn::Max(hn::Min(blocks, set(float{volume::kWidestGap + 1})), set(1.0f)));
}

HWY_INLINE F load(const DiscBatch::Floats& from, size_t lane) {
    return hn::Load(Floats(), from.data() + lane);
}
HWY_INLINE void store(F v, DiscBatch::Floats& to, size_t lane) {
    hn::Store(v, Floats(), to.data() + lane);
}
HWY_INLINE void store(hn::Vec<Ints> v, DiscBatch::Ints& to, size_t lane) {
    hn::Store(v, Ints(), to.data() + lane);
}

HWY_INLINE void prepare_lanes(const RawDiscs& raw, const Grid& grid, DiscBatch& batch, size_t lane) {
    const Ints di;
    const F voxel = set(grid.voxel), one = set(1.0f), touching = set(kTouching);
    const F radius = over(hn::Min(load(raw.radius, lane), set(volume::kLargestRadius * grid.voxel)), voxel);
    store(radius, batch.radius, lane);
    F area = load(raw.area, lane);
    const F disc = mul(mul(set(kPi), mul(radius, radius)), mul(voxel, voxel));
    area = hn::IfThenElse(hn::Gt(area, hn::Zero(Floats())), area, disc);
    store(area, batch.area, lane);
    store(gap_of(radius, over(area, mul(voxel, voxel))), batch.gap, lane);
    const V3 normal = decode_octahedral(hn::Load(Words(), raw.normal.data() + lane));
    const F normals[] = {normal.x, normal.y, normal.z};
    const F per_voxel = set(float{kBlocksAlong}), beside = set(kTouchingBlocks);
    for (size_t axis = 0; axis < 3; ++axis) {
        const F place =
            over(sub(load(raw.position[axis], lane), set(grid.low[static_cast<int>(axis)])), voxel);
        const F n = normals[axis];
        const F across = hn::Sqrt(hn::Max(sub(one, mul(n, n)), hn::Zero(Floats())));
        const F reach = mul(radius, across);
        const F low = sub(sub(place, reach), touching), high = add(add(place, reach), touching);
        const auto first = to_int(di, low), last = to_int(di, high);
        const F corner = hn::ConvertTo(Floats(), first);
        const auto block = [&](F at) { return to_int(di, hn::Max(at, hn::Zero(Floats()))); };
        const F distance = over(sub(hn::ConvertTo(Floats(), last), place), hn::Max(reach, touching));
        store(place, batch.place[axis], lane);
        store(n, batch.normal[axis], lane);
        store(across, batch.across[axis], lane);
        store(first, batch.first[axis], lane);
        store(last, batch.last[axis], lane);
        store(block(sub(mul(per_voxel, sub(low, corner)), beside)), batch.low_block[axis], lane);
        store(block(add(mul(per_voxel, sub(high, corner)), beside)), batch.high_block[axis], lane);
        store(distance, batch.distance[axis], lane);
        store(share_before(distance), batch.below[axis], lane);
    }
}

void PrepareDiscs(const RawDiscs& raw, size_t count, const Grid& grid, DiscBatch& batch) {
    for (size_t lane = 0; lane < count; lane += kDiscLanes) prepare_lanes(raw, grid, batch, lane);
}

}  // namespace lucarne::gi::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::native {

HWY_EXPORT(PrepareDiscs);
void prepare_raw(const RawDiscs& raw, size_t count, const volume::Grid& grid, DiscBatch& batch) {
    HWY_DYNAMIC_DISPATCH(PrepareDiscs)(raw, count, grid, batch);
}

}  // namespace lucarne::gi::native

namespace lucarne::gi::volume {

void prepare_discs(std::span<const FlatSurfel> surfels, const Grid& grid, DiscBatch& batch) {
    native::RawDiscs raw;
    // Lanes from the last disc on repeat it.
    for (size_t i = 0; i < DiscBatch::kMost; ++i) {
        const FlatSurfel& surfel = surfels[std::min(i, surfels.size() - 1)];
        raw.position[0][i] = surfel.x, raw.position[1][i] = surfel.y, raw.position[2][i] = surfel.z;
        raw.radius[i] = surfel.radius, raw.area[i] = surfel.area, raw.normal[i] = surfel.normal;
    }
    native::prepare_raw(raw, surfels.size(), grid, batch);
}

}  // namespace lucarne::gi::volume
#endif
