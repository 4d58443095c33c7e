#include "gi/gather/upsample.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "io/core/parallel.h"

namespace lucarne::gi {
namespace {

/// Returns how well the light of one surface point stands for that of another, 0 to 1. `reach`: the distance
/// from their planes within which they are one surface, m.
float likeness(const SurfacePoint& a, const SurfacePoint& b, float reach) {
    if (!(b.radius > 0)) return 0;
    const float cosine = glm::dot(a.normal, b.normal);
    if (cosine <= 0) return 0;
    const float away = std::abs(glm::dot(a.normal, b.position - a.position)) / reach;
    const float cosine4 = cosine * cosine * cosine * cosine;
    return cosine4 * cosine4 * cosine4 * cosine4 * std::max(0.0f, 1 - away);
}

}  // namespace

uint32_t GatherGrid::pixel(uint32_t column, uint32_t row) const {
    return std::min(row * step + y, height - 1) * width + std::min(column * step + x, width - 1);
}

std::vector<uint32_t> GatherGrid::pixels() const {
    std::vector<uint32_t> all;
    for (uint32_t row = 0; row < rows(); ++row)
        for (uint32_t column = 0; column < columns(); ++column) all.push_back(pixel(column, row));
    return all;
}

std::vector<uint32_t> upsample(const CameraView& camera, std::span<const SurfacePoint> surfaces,
                               const GatherGrid& grid, std::span<const glm::vec4> gathered,
                               std::span<glm::vec4> light) {
    const auto columns = static_cast<int>(grid.columns()), rows = static_cast<int>(grid.rows());
    const float pixel_size = 2 * glm::length(glm::vec3(camera.up)) / static_cast<float>(grid.height);
    const bool parallel = camera.projection == kOrthographic;
    std::vector<std::vector<uint32_t>> missing(grid.height);
    parallel_ranges(grid.height, 8, [&](size_t first, size_t last) {
        for (size_t y = first; y < last; ++y)
            for (size_t x = 0; x < grid.width; ++x) {
                const size_t pixel = y * grid.width + x;
                const SurfacePoint& at = surfaces[pixel];
                light[pixel] = glm::vec4(0.0f);
                if (!(at.radius > 0)) continue;
                const float depth = parallel ? 1 : glm::distance(at.position, glm::vec3(camera.origin));
                const float reach = static_cast<float>(grid.step) * pixel_size * depth + at.radius;
                const float u =
                    (static_cast<float>(x) - static_cast<float>(grid.x)) / static_cast<float>(grid.step);
                const float v =
                    (static_cast<float>(y) - static_cast<float>(grid.y)) / static_cast<float>(grid.step);
                const int left = static_cast<int>(std::floor(u)), upper = static_cast<int>(std::floor(v));
                glm::vec4 sum(0.0f);
                float weights = 0;
                for (int k = 0; k < 4; ++k) {
                    const int column = left + (k & 1), row = upper + (k >> 1);
                    const float share =
                        (k & 1 ? u - static_cast<float>(left) : 1 - u + static_cast<float>(left)) *
                        (k >> 1 ? v - static_cast<float>(upper) : 1 - v + static_cast<float>(upper));
                    if (column < 0 || row < 0 || column >= columns || row >= rows) continue;
                    const uint32_t other =
                        grid.pixel(static_cast<uint32_t>(column), static_cast<uint32_t>(row));
                    const float weight = (share + kLeastUpsampleShare) * likeness(at, surfaces[other], reach);
                    sum += weight * gathered[static_cast<size_t>(row * columns + column)];
                    weights += weight;
                }
                if (weights >= kLeastUpsampleWeight)
                    light[pixel] = sum / weights;
                else
                    missing[y].push_back(static_cast<uint32_t>(pixel));
            }
    });
    std::vector<uint32_t> all;
    for (const auto& row : missing) all.insert(all.end(), row.begin(), row.end());
    return all;
}

}  // namespace lucarne::gi
