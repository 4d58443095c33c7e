#include "gi/engines/paths/arriving_light.h"

#include <utility>

#include <glm/geometric.hpp>

#include "gi/engines/paths/cosine_rays.h"
#include "io/core/parallel.h"

namespace lucarne::gi::paths {
namespace {

constexpr size_t kPointsATask = 64;
/// A lobe that meets less than this of a ray reflects the mean of all light.
constexpr float kLeastRays = 1e-2f;

}  // namespace

ArrivingLight::ArrivingLight(std::shared_ptr<const PathsBake> bake) : bake_(std::move(bake)) {
    const LightPaths& paths = bake_->paths;
    cell_of_.resize(paths.points.size() * paths.rays_a_point);
    rays_in_.resize(paths.points.size() * kDirectionCells);
    parallel_ranges(paths.points.size(), kPointsATask, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const GatheringPoint& point = paths.points[i];
            const CosineDirections directions(point.normal, bake_->seed, point.side);
            for (uint32_t ray = 0; ray < paths.rays_a_point; ++ray) {
                const uint32_t cell = direction_cell(directions[ray]);
                cell_of_[i * paths.rays_a_point + ray] = static_cast<uint8_t>(cell);
                uint8_t& rays = rays_in_[i * kDirectionCells + cell];
                rays += rays < 255;
            }
        }
    });
}

void ArrivingLight::set(std::span<const glm::vec3> radiosity, std::span<const glm::vec3> of_lobes,
                        const PointSky* sky, std::span<const Material> materials) {
    const LightPaths& paths = bake_->paths;
    light_.assign(paths.points.size() * kDirectionCells, glm::vec3(0.0f));
    parallel_ranges(paths.points.size(), kPointsATask, [&](size_t begin, size_t end) {
        for (size_t point = begin; point < end; ++point) {
            size_t open = 0;
            for (size_t ray = point * paths.rays_a_point; ray < (point + 1) * paths.rays_a_point; ++ray) {
                glm::vec3& light = light_[point * kDirectionCells + cell_of_[ray]];
                if (paths.rays[ray] == kNone) {
                    if (sky) light += kPi * sky->radiance(point, open++);
                } else if (!radiosity.empty()) {
                    light += radiosity[paths.rays[ray]];
                    if (!of_lobes.empty()) light += of_lobes[ray];
                }
            }
        }
    });
    albedos_.take(materials);
}

glm::vec3 ArrivingLight::reflected(std::span<const PointShare> about, const glm::vec3& irradiance,
                                   const Reflectance& surface, const glm::vec3& normal,
                                   const glm::vec3& to) const {
    const float cosine = glm::dot(normal, to);
    const LobeAlbedo* albedo = albedos_.find(surface.exponent);
    if (cosine <= 0 || !albedo) return glm::vec3(0.0f);
    glm::vec3 light(0.0f);
    float rays = 0;
    const LobeCells::Lobe lobe(surface.exponent, normal, to);
    for (uint32_t cell = 0; cell < kDirectionCells; ++cell) {
        const float weight = lobe.at(cells_.direction(cell));
        if (!(weight > 0)) continue;
        for (const PointShare& s : about) {
            const size_t at = s.point * size_t{kDirectionCells} + cell;
            light += s.share * weight * light_[at];
            rays += s.share * weight * static_cast<float>(rays_in_[at]);
        }
    }
    const glm::vec3 mean = rays > kLeastRays ? light / rays : irradiance;
    return surface.ks * albedo->at(cosine) / kPi * mean;
}

}  // namespace lucarne::gi::paths
