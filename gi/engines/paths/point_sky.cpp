#include "gi/engines/paths/point_sky.h"

#include <algorithm>
#include <utility>

#include "gi/engines/paths/cosine_rays.h"
#include "gi/lighting/sky_directions.h"
#include "gi/lighting/sky_grid.h"
#include "gi/shared/brdf.h"
#include "gi/shared/luminance.h"
#include "gi/shared/surfel_code.h"
#include "io/core/parallel.h"

namespace lucarne::gi::paths {
namespace {

constexpr size_t kSkiesATask = 256;

}  // namespace

PointSky::PointSky(std::shared_ptr<const PathsBake> bake) : bake_(std::move(bake)) {
    const LightPaths& paths = bake_->paths;
    first_.assign(paths.points.size() + 1, 0);
    const auto rays_of = [&](size_t point) {
        return std::span(paths.rays).subspan(point * paths.rays_a_point, paths.rays_a_point);
    };
    for (size_t i = 0; i < paths.points.size(); ++i)
        first_[i + 1] = first_[i] + static_cast<uint32_t>(std::ranges::count(rays_of(i), kNone));
    open_.resize(first_.back());
    cells_.resize(first_.back());
    parallel_ranges(paths.points.size(), kSkiesATask, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const GatheringPoint& point = paths.points[i];
            const CosineDirections directions(point.normal, bake_->seed, point.side);
            uint32_t next = first_[i];
            for (uint32_t ray = 0; ray < paths.rays_a_point && next < first_[i + 1]; ++ray)
                if (rays_of(i)[ray] == kNone) {
                    const glm::vec3 direction = directions[ray];
                    cells_[next] = static_cast<uint16_t>(sky_cell(direction));
                    open_[next++] = encode_octahedral(direction);
                }
        }
    });
}

glm::vec3 PointSky::radiance(size_t point, size_t ray) const {
    return sky_->texels.empty() ? glm::vec3(0.0f)
                                : sky_->radiance(decode_octahedral(open_[first_[point] + ray]));
}

void PointSky::set(const GatherSky& sky) {
    irradiance_.assign(bake_->paths.points.size(), glm::vec3(0.0f));
    luminances_.assign(kSkyCells, 0.0f);
    sky_ = &sky;
    if (sky.texels.empty()) return;
    for (uint32_t cell = 0; cell < kSkyCells; ++cell)
        luminances_[cell] = luminance(sky.radiance(sky_direction(cell, 0.5, 0.5)));
    const float share = kPi / static_cast<float>(bake_->paths.rays_a_point);
    parallel_ranges(irradiance_.size(), kSkiesATask, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            glm::vec3 sum(0.0f);
            for (uint32_t open = first_[i]; open < first_[i + 1]; ++open)
                sum += sky.radiance(decode_octahedral(open_[open]));
            irradiance_[i] = share * sum;
        }
    });
}

}  // namespace lucarne::gi::paths
