#include "gi/lighting/nested_views.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/surfels/surfel_pool.h"

namespace lucarne::gi {
namespace {

/// The finest of so many is 256 times as narrow as the scan is wide.
constexpr uint32_t kMostNested = 5;
/// Texels may be this many times as wide as the median distance between points.
constexpr float kCoarsest = 2;
/// A finer view is of use to at least this share of the points.
constexpr float kLeastShare = .1f;
/// The middle moves in steps of this share of half the finest view's width.
constexpr float kStep = .25f;

/// Points of a node: how far from the camera, how far apart (m), how many.
struct Group {
    float distance, spacing;
    uint32_t count;
};

std::vector<Group> groups_of(const DeviceCut& cut, const glm::vec3& eye) {
    const std::span<const CutItem> items = cut.items();
    std::vector<uint32_t> counts(items.size(), 0);
    for (const CutBlock& block : cut.block_list()) counts[block.item] += block.count;
    std::vector<Group> groups;
    for (size_t i = 0; i < items.size(); ++i) {
        if (counts[i] == 0) continue;
        const glm::vec3 middle = items[i].origin + items[i].size / 2;
        groups.push_back(
            {glm::length(middle - eye), items[i].size / std::sqrt(static_cast<float>(counts[i])), counts[i]});
    }
    return groups;
}

}  // namespace

void set_nested_views(const glm::vec3& eye, const Bounds& bounds, const DeviceCut& cut, uint32_t resolution,
                      Light& light) {
    std::vector<Group> groups = groups_of(cut, eye);
    std::ranges::sort(groups, {}, &Group::spacing);
    uint64_t all = 0, finer = 0;
    for (const Group& group : groups) all += group.count;
    float spacing = 0;
    for (const Group& group : groups) {
        spacing = group.spacing;
        if (2 * (finer += group.count) >= all) break;
    }
    const auto share_within = [&](float distance) {
        uint64_t within = 0;
        for (const Group& group : groups)
            if (group.distance < distance) within += group.count;
        return static_cast<float>(within) / static_cast<float>(std::max<uint64_t>(all, 1));
    };
    float half = glm::length(bounds.max - bounds.min) / 2;
    light.nested = 1;
    while (light.nested < kMostNested && 2 * half / static_cast<float>(resolution) > kCoarsest * spacing &&
           share_within(half / kNestedStep) > kLeastShare) {
        half /= kNestedStep;
        ++light.nested;
    }
    if (light.nested == 1) return;
    // Motion along the light changes no view.
    const glm::vec3 direction(light.direction), middle = (bounds.min + bounds.max) / 2.0f;
    const glm::vec3 beside = eye - direction * glm::dot(eye - middle, direction);
    const float step = kStep * half;
    light.position = glm::vec4(glm::floor(beside / step + .5f) * step, half);
}

Light without_nested_views(Light light) {
    if (light.kind != kDirectionalLight) return light;
    light.nested = 0;
    light.position = glm::vec4(0.0f);
    return light;
}

}  // namespace lucarne::gi
