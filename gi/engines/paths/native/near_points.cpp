#include "gi/engines/paths/native/near_points.h"

#include <bit>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "gi/engines/paths/native/near_points.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include "gi/native/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace lucarne::gi::paths::native::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using gi::native::HWY_NAMESPACE::kRowLanes, gi::native::HWY_NAMESPACE::Row,
    gi::native::HWY_NAMESPACE::RowFloats;

/// What rounding may take from an error.
constexpr float kSlack = 1.0001f;

size_t FindNear(std::span<const PointBlock> blocks, float turn, const glm::vec3& position,
                const glm::vec3& normal, uint32_t* found) {
    const RowFloats df;
    const auto set = [&](float value) { return hn::Set(df, value); };
    const auto sum_of = [](Row a, Row b, Row c) { return hn::Add(hn::Add(a, b), c); };
    const Row least_cosine = set(1 - kSlack * turn * turn);
    size_t count = 0;
    for (const PointBlock& block : blocks)
        for (size_t i = 0; i < PointBlock::kPoints; i += static_cast<size_t>(kRowLanes)) {
            const auto load = [&](const auto& values) { return hn::LoadU(df, values.data() + i); };
            const Row x = hn::Sub(set(position.x), load(block.x)),
                      y = hn::Sub(set(position.y), load(block.y)),
                      z = hn::Sub(set(position.z), load(block.z));
            const Row nx = load(block.normal_x), ny = load(block.normal_y), nz = load(block.normal_z);
            const Row across = sum_of(hn::Mul(x, nx), hn::Mul(y, ny), hn::Mul(z, nz));
            const Row distance2 = hn::Add(sum_of(hn::Mul(x, x), hn::Mul(y, y), hn::Mul(z, z)),
                                          hn::Mul(set(kAcross * kAcross - 1), hn::Mul(across, across)));
            const Row cosine =
                sum_of(hn::Mul(set(normal.x), nx), hn::Mul(set(normal.y), ny), hn::Mul(set(normal.z), nz));
            const auto near = hn::And(hn::Lt(hn::Mul(distance2, load(block.per_reach2)), set(kSlack)),
                                      hn::Gt(cosine, least_cosine));
            uint8_t bits[8] = {};
            hn::StoreMaskBits(df, near, bits);
            for (uint32_t lanes = bits[0]; lanes != 0; lanes &= lanes - 1)
                found[count++] = block.numbers[i + static_cast<size_t>(std::countr_zero(lanes))];
        }
    return count;
}

}  // namespace lucarne::gi::paths::native::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lucarne::gi::paths::native {

HWY_EXPORT(FindNear);

size_t find_near(std::span<const PointBlock> blocks, float turn, const glm::vec3& position,
                 const glm::vec3& normal, uint32_t* found) {
    return HWY_DYNAMIC_DISPATCH(FindNear)(blocks, turn, position, normal, found);
}

std::vector<PointBlock> point_blocks(std::span<const GatheringPoint> points,
                                     std::span<const uint32_t> numbers, float factor) {
    std::vector<PointBlock> blocks(numbers.size() / PointBlock::kPoints);
    for (size_t i = 0; i < numbers.size(); ++i) {
        PointBlock& block = blocks[i / PointBlock::kPoints];
        const size_t lane = i % PointBlock::kPoints;
        block.x[lane] = 1e30f;  // of no point: too far from everything
        block.per_reach2[lane] = 1;
        block.numbers[lane] = numbers[i];
        if (numbers[i] == kNone) continue;
        const GatheringPoint& point = points[numbers[i]];
        block.x[lane] = point.position.x;
        block.y[lane] = point.position.y;
        block.z[lane] = point.position.z;
        block.normal_x[lane] = point.normal.x;
        block.normal_y[lane] = point.normal.y;
        block.normal_z[lane] = point.normal.z;
        block.per_reach2[lane] = 1 / (factor * point.reach * factor * point.reach);
    }
    return blocks;
}

}  // namespace lucarne::gi::paths::native
#endif
