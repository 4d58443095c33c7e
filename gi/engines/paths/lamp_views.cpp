#include "gi/engines/paths/lamp_views.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "io/core/parallel.h"

namespace lucarne::gi::paths {
namespace {

constexpr float kAlongLongest = 4;  ///< positions along the longest side of the region
constexpr uint32_t kRaysOfLamp = 4096;
constexpr size_t kPositionsAtOnce = 8, kRaysATask = 256;
constexpr double kGoldenRatio = 0.6180339887498949;

/// Returns direction `i` of a spherical Fibonacci lattice.
glm::vec3 even_direction(size_t i) {
    const double z = 1 - (2.0 * static_cast<double>(i) + 1) / kRaysOfLamp, sine = std::sqrt(1 - z * z);
    const double phi = 2 * M_PI * kGoldenRatio * static_cast<double>(i);
    return {sine * std::cos(phi), sine * std::sin(phi), z};
}

}  // namespace

std::vector<glm::vec3> lamp_positions(const Bounds& region) {
    const glm::vec3 size = region.max - region.min;
    const float longest = std::max({size.x, size.y, size.z, 1e-6f});
    const glm::ivec3 counts = glm::max(glm::ivec3(glm::round(kAlongLongest * size / longest)), 1);
    std::vector<glm::vec3> positions;
    for (int z = 0; z < counts.z; ++z)
        for (int y = 0; y < counts.y; ++y)
            for (int x = 0; x < counts.x; ++x)
                positions.push_back(region.min + (glm::vec3(x, y, z) + .5f) / glm::vec3(counts) * size);
    return positions;
}

LampViews::LampViews(const Surfaces& surfaces, std::span<const uint32_t> leaf_of, size_t leaves,
                     const Bounds& region)
    : surfaces_(surfaces), leaf_of_(leaf_of), positions_(lamp_positions(region)), seen_(leaves, 0) {}

bool LampViews::advance() {
    const size_t last = std::min(positions_.size(), next_ + kPositionsAtOnce);
    std::vector<uint32_t> leaves(kRaysOfLamp);
    for (; next_ < last; ++next_) {
        const glm::vec3& from = positions_[next_];
        parallel_ranges(kRaysOfLamp, kRaysATask, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                const glm::vec3 direction = even_direction(i);
                const auto hit = surfaces_.tracer().first_hit(from, direction);
                leaves[i] = hit ? leaf_of_[surfaces_.side_of(*hit, from + hit->distance * direction)] : kNone;
            }
        });
        std::ranges::sort(leaves);
        for (size_t first = 0; first < kRaysOfLamp && leaves[first] != kNone;) {
            size_t end = first + 1;
            while (end < kRaysOfLamp && leaves[end] == leaves[first]) ++end;
            float& most = seen_[leaves[first]];
            most = std::max(most, static_cast<float>(end - first) / kRaysOfLamp);
            first = end;
        }
    }
    return next_ < positions_.size();
}

void add_seen(std::span<uint32_t> counts, std::span<const float> seen, std::span<const uint32_t> limits,
              double enough, double most) {
    const auto raised = [&](size_t leaf, double share) {
        const double wanted = std::ceil(share * enough * double{seen[leaf]});
        return std::max(counts[leaf], static_cast<uint32_t>(std::min<double>(wanted, limits[leaf])));
    };
    const auto added = [&](double share) {
        double sum = 0;
        for (size_t leaf = 0; leaf < counts.size(); ++leaf)
            if (counts[leaf] > 0) sum += raised(leaf, share) - counts[leaf];
        return sum;
    };
    double share = 1;
    if (added(share) > most) {
        double too_many = 1;
        share = 0;
        for (int step = 0; step < 24; ++step) {
            const double middle = (share + too_many) / 2;
            (added(middle) > most ? too_many : share) = middle;
        }
    }
    for (size_t leaf = 0; leaf < counts.size(); ++leaf)
        if (counts[leaf] > 0) counts[leaf] = raised(leaf, share);
}

}  // namespace lucarne::gi::paths
