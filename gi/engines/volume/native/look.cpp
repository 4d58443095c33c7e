#include "gi/engines/volume/native/look.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/shared/luminance.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/engines/volume/native/look.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/native/vectors-inl.h"

#ifndef LUCARNE_VOLUME_NATIVE_LOOK_ONCE
#define LUCARNE_VOLUME_NATIVE_LOOK_ONCE
namespace lucarne::gi::native {

using volume::Cluster, volume::Ray, volume::Receiver;

struct LookJob {
    std::span<const Cluster> clusters;
    size_t first, last;
    std::span<const Receiver> receivers;
    float in_plane;
    std::span<std::vector<Ray>> rays;
};

/// A cluster is small enough if its radius is at most this share of its distance.
inline constexpr float kOpening = 0.3f;
/// Length of the mean normal of a cluster that may stand for its faces: their normals lie within some 25
/// degrees of it.
inline constexpr float kOneDirection = 0.9f;
/// Faces nearer than so many times their side have the form factor of a square, others that of a point.
inline constexpr float kNearbySides = 4;

}  // namespace lucarne::gi::native
#endif

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::native::HWY_NAMESPACE {

constexpr size_t kLookLanes = hn::MaxLanes(Floats());
static_assert(kLookLanes <= volume::kReceiversTogether);

/// Receivers in a row; lanes from the last one on repeat it.
struct ReceiverLanes {
    V3 position, normal;
    U voxel;
    uint32_t used;  ///< bits
};

HWY_INLINE V3 from(const glm::vec3& v) {
    return {set(v.x), set(v.y), set(v.z)};
}
HWY_INLINE V3 minus(const V3& a, const V3& b) {
    return {sub(a.x, b.x), sub(a.y, b.y), sub(a.z, b.z)};
}

HWY_INLINE ReceiverLanes load(std::span<const Receiver> receivers) {
    alignas(64) float places[6][kLookLanes];
    alignas(64) uint32_t voxels[kLookLanes];
    for (size_t i = 0; i < kLookLanes; ++i) {
        const Receiver& receiver = receivers[std::min(i, receivers.size() - 1)];
        for (int axis = 0; axis < 3; ++axis) {
            places[axis][i] = receiver.position[axis];
            places[3 + axis][i] = receiver.normal[axis];
        }
        voxels[i] = receiver.voxel;
    }
    const auto at = [&](int i) { return hn::Load(Floats(), places[i]); };
    return {{at(0), at(1), at(2)},
            {at(3), at(4), at(5)},
            hn::Load(Words(), voxels),
            (uint32_t{1} << std::min(receivers.size(), kLookLanes)) - 1};
}

/// Returns how far the box of a cluster reaches from a position along a direction, m.
HWY_INLINE F farthest(const Cluster& cluster, const V3& position, const V3& along) {
    const V3 low = minus(from(cluster.low), position), high = minus(from(cluster.high), position);
    const auto most = [](F a, F b, F by) { return hn::Max(mul(a, by), mul(b, by)); };
    return add(add(most(low.x, high.x, along.x), most(low.y, high.y, along.y)), most(low.z, high.z, along.z));
}

/// Returns the irradiance, W/m^2, of receivers by a square with the unit normal `square`, for each W/sr that
/// it would send out along its normal. `way`: from the receivers to the middle of the square, m. The kernel
/// is expanded to second order about the middle: its mean over a square is its value plus area / 24 times its
/// Laplacian in the plane of the square.
HWY_INLINE F factor_of_small(const V3& normal, const V3& way, F distance2, const V3& square, float area) {
    const F zero = hn::Zero(Floats());
    const F above = dot(way, normal), facing = hn::Neg(dot(way, square));
    const V3 lift = scaled(square, facing);
    const V3 along{add(way.x, lift.x), add(way.y, lift.y), add(way.z, lift.z)};  // in the plane of the square
    const F distance4 = mul(distance2, distance2);
    const F laplacian =
        sub(over(sub(mul(set(16), dot(along, along)), mul(set(8), mul(facing, facing))), distance4),
            over(mul(set(8), dot(normal, along)), mul(distance2, above)));
    const F bend = add(set(1), mul(set(area / 24), laplacian));
    const F factor = mul(over(mul(above, facing), distance4), hn::Min(hn::Max(bend, zero), set(2)));
    return hn::IfThenElseZero(hn::And(hn::Gt(above, zero), hn::Gt(facing, zero)), factor);
}

void add_rays(const LookJob& job, const ReceiverLanes& lanes, size_t first_lane, size_t number, const V3& way,
              F distance2, float length2, Mask accepted) {
    const Floats df;
    const Cluster& cluster = job.clusters[number];
    accepted = hn::And(accepted, hn::Ge(dot(way, lanes.normal), set(-cluster.radius)));
    accepted = hn::And(accepted, hn::Le(dot(way, from(cluster.normal)), set(cluster.radius)));
    Mask near = hn::Lt(distance2, distance2);  // none
    if (cluster.faces == 1) {
        // Surfaces in one voxel are too near to each other for its resolution.
        accepted = hn::AndNot(hn::RebindMask(df, hn::Eq(lanes.voxel, word(cluster.voxel))), accepted);
        near = hn::And(accepted, hn::Lt(distance2, set(kNearbySides * kNearbySides * cluster.area)));
    }
    uint32_t bits = bits_of(accepted) & lanes.used;
    if (bits == 0) return;
    const uint32_t near_bits = bits_of(near);
    alignas(64) float factors[kLookLanes];
    const float length = std::sqrt(length2);
    hn::Store(factor_of_small(lanes.normal, way, distance2, from(cluster.normal / length), cluster.area), df,
              factors);
    for (; bits != 0; bits &= bits - 1) {
        const auto lane = static_cast<size_t>(std::countr_zero(bits));
        auto& rays = job.rays[first_lane + lane];
        if (near_bits >> lane & 1u) {
            rays.push_back({cluster.power, Ray::kNearby, static_cast<uint32_t>(number)});
            continue;
        }
        const glm::vec3 light = factors[lane] * cluster.power;
        if (factors[lane] > 0) rays.push_back({light, luminance(light), static_cast<uint32_t>(number)});
    }
}

void look_from(const LookJob& job, size_t first_lane) {
    const Floats df;
    const size_t count = std::min(job.receivers.size() - first_lane, kLookLanes);
    const ReceiverLanes lanes = load(job.receivers.subspan(first_lane, count));
    const Ints di;
    auto next = hn::Zero(di);  // the cluster at which each lane goes on
    for (size_t i = job.first; i < job.last;) {
        const Cluster& cluster = job.clusters[i];
        const size_t after = i + 2 * size_t{cluster.faces} - 1;  // beyond all of its clusters
        const Mask active = hn::RebindMask(df, hn::Lt(next, hn::Set(di, static_cast<int32_t>(i) + 1)));
        const V3 way = minus(from(cluster.middle), lanes.position);
        const F distance2 = dot(way, way);
        const float length2 = glm::dot(cluster.normal, cluster.normal);
        if (cluster.faces == 1) {
            add_rays(job, lanes, first_lane, i, way, distance2, length2, active);
            i = after;
            continue;
        }
        Mask small = hn::Lt(distance2, distance2);  // none
        if (length2 > kOneDirection * kOneDirection)
            small = hn::And(active, hn::Lt(set(cluster.radius * cluster.radius),
                                           mul(set(kOpening * kOpening), distance2)));
        Mask opened = hn::AndNot(small, active);
        if (!hn::AllFalse(df, opened)) {
            // All of it may be below the horizon, or face away.
            const F limit = set(job.in_plane);
            const F spread = hn::Sqrt(mul(set(std::max(1 - length2, 0.0f)), distance2));
            const Mask hidden =
                hn::Or(hn::Lt(farthest(cluster, lanes.position, lanes.normal), limit),
                       hn::Lt(add(farthest(cluster, lanes.position, from(-cluster.normal)), spread), limit));
            opened = hn::AndNot(hidden, opened);
        }
        if (!hn::AllFalse(df, small)) add_rays(job, lanes, first_lane, i, way, distance2, length2, small);
        const Mask closed = hn::AndNot(opened, active);
        next = hn::IfThenElse(hn::RebindMask(di, closed), hn::Set(di, static_cast<int32_t>(after)), next);
        i = hn::AllFalse(df, opened) ? after : i + 1;
    }
}

void LookAll(const LookJob& job) {
    for (size_t i = 0; i < job.receivers.size(); i += kLookLanes) look_from(job, i);
}

}  // namespace lucarne::gi::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::native {

HWY_EXPORT(LookAll);
void look_all(const LookJob& job) {
    HWY_DYNAMIC_DISPATCH(LookAll)(job);
}

}  // namespace lucarne::gi::native

namespace lucarne::gi::volume {

void look(std::span<const Cluster> clusters, size_t first, size_t last, std::span<const Receiver> receivers,
          float in_plane, std::span<std::vector<Ray>> rays) {
    native::look_all({clusters, first, last, receivers, in_plane, rays});
}

}  // namespace lucarne::gi::volume
#endif
