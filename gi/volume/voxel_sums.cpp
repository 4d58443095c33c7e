#include "gi/volume/voxel_sums.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

namespace lucarne::gi::volume {
namespace {

/// A mean normal that is shorter than this belongs to sides that cancel each other.
constexpr double kLeastNormal = 1e-3;

}  // namespace

void VoxelSums::add(std::vector<VoxelPart>& parts) {
    std::ranges::stable_sort(parts, {}, &VoxelPart::cell);
    std::vector<Sum> joined;
    joined.reserve(sums_.size());
    auto old = sums_.begin();
    for (size_t i = 0; i < parts.size();) {
        const uint32_t cell = parts[i].cell;
        for (; old != sums_.end() && old->cell < cell; ++old) joined.push_back(*old);
        Sum sum{cell, 0, glm::dvec3(0.0), glm::dvec3(0.0)};
        if (old != sums_.end() && old->cell == cell) sum = *old++;
        for (; i < parts.size() && parts[i].cell == cell; ++i) {
            sum.area += static_cast<double>(parts[i].area);
            sum.normal += glm::dvec3(parts[i].normal);
            sum.albedo += glm::dvec3(parts[i].albedo);
        }
        joined.push_back(sum);
    }
    joined.insert(joined.end(), old, sums_.end());
    sums_ = std::move(joined);
}

VoxelSet VoxelSums::means(const Grid& grid, const glm::dvec3& origin) const {
    VoxelSet set{grid, origin, {}};
    set.voxels.reserve(sums_.size());
    const double face = std::pow(static_cast<double>(grid.voxel), 2);
    for (const Sum& sum : sums_) {
        const double length = glm::length(sum.normal);
        set.voxels.push_back(
            {sum.cell, static_cast<float>(sum.area * face),
             length > kLeastNormal * sum.area ? glm::vec3(sum.normal / length) : glm::vec3(0.0f),
             sum.area > 0 ? glm::vec3(sum.albedo / sum.area) : glm::vec3(0.0f)});
    }
    return set;
}

}  // namespace lucarne::gi::volume
