#include "gi/engines/paths/native/moved_light.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/engines/paths/native/moved_light.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/native/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::paths::native::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using gi::native::HWY_NAMESPACE::kRowLanes, gi::native::HWY_NAMESPACE::Row,
    gi::native::HWY_NAMESPACE::RowFloats;

/// Least product of squared distances, m^4: a place may be where a ray ended.
constexpr float kLeastDistance4 = 1e-12f;
/// Sums of so many vectors make up the eight lanes of a block, whatever the width of the vectors.
constexpr int kParts = static_cast<int>(RayBlock::kRays) / kRowLanes;

RaySums AddMoved(std::span<const RayBlock> blocks, const glm::vec3& place, const glm::vec3& normal,
                 float radius2) {
    const RowFloats df;
    const auto set = [&](float value) { return hn::Set(df, value); };
    const auto dot = [](Row ax, Row ay, Row az, Row bx, Row by, Row bz) {
        return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
    };
    const Row zero = hn::Zero(df), most = set(kMostTimes), least = set(kLeastDistance4);
    Row lights[kParts], times[kParts];
    for (int part = 0; part < kParts; ++part) lights[part] = times[part] = zero;
    for (const RayBlock& block : blocks)
        for (int part = 0; part < kParts; ++part) {
            const auto load = [&](const auto& values) {
                return hn::LoadU(df, values.data() + part * kRowLanes);
            };
            const Row x = hn::Sub(load(block.x), set(place.x)), y = hn::Sub(load(block.y), set(place.y)),
                      z = hn::Sub(load(block.z), set(place.z));
            const Row distance2 = dot(x, y, z, x, y, z);
            const Row here = hn::Max(dot(x, y, z, set(normal.x), set(normal.y), set(normal.z)), zero);
            const Row there = hn::Max(
                hn::Neg(dot(x, y, z, load(block.normal_x), load(block.normal_y), load(block.normal_z))),
                zero);
            const Row distance4 = hn::Max(hn::Mul(distance2, hn::Add(distance2, set(radius2))), least);
            const Row time =
                hn::Min(hn::Div(hn::Mul(load(block.weight), hn::Mul(here, there)), distance4), most);
            lights[part] = hn::Add(lights[part], hn::Mul(time, load(block.light)));
            times[part] = hn::Add(times[part], time);
        }
    const auto sum = [&](const Row* parts) {
        std::array<float, RayBlock::kRays> lanes;
        for (int part = 0; part < kParts; ++part)
            hn::StoreU(parts[part], df, lanes.data() + part * kRowLanes);
        return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) +
               ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
    };
    return {sum(lights), sum(times)};
}

}  // namespace lucarne::gi::paths::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::paths::native {

HWY_EXPORT(AddMoved);

RaySums add_moved(std::span<const RayBlock> blocks, const glm::vec3& place, const glm::vec3& normal,
                  float radius2) {
    return HWY_DYNAMIC_DISPATCH(AddMoved)(blocks, place, normal, radius2);
}

}  // namespace lucarne::gi::paths::native
#endif
