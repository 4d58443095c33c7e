#include "gi/engines/paths/arriving_light.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "gi/engines/paths/cosine_rays.h"
#include "gi/shared/surfel_code.h"
#include "io/core/parallel.h"

namespace lucarne::gi::paths {
namespace {

constexpr size_t kPointsATask = 64;
/// A lobe that meets less than this of a ray reflects the mean of all light.
constexpr float kLeastRays = 1e-2f;
/// Cells in which a lobe has less than this of its peak are left out.
constexpr float kLeastLobe = 1e-3f;

/// Returns the exponent of a lobe that has the width of cos^n once the cells have widened it. Along each axis
/// cos^n has the variance 1 / n, and a square of the solid angle w that of w / 12.
float narrowed(float exponent) {
    constexpr float kVariance = 4 * kPi / ArrivingLight::kCells / 12;
    return 1 / std::max(1 / exponent - kVariance, 1 / ArrivingLight::kLargestExponent);
}

uint32_t cell_of(const glm::vec3& direction) {
    const uint32_t code = encode_octahedral(direction);
    const uint32_t x = (code & 0xffffu) * ArrivingLight::kSide >> 16,
                   y = (code >> 16) * ArrivingLight::kSide >> 16;
    return y * ArrivingLight::kSide + x;
}
glm::vec3 middle_of(uint32_t cell) {
    const auto code = [](uint32_t at) { return (2 * at + 1) * 0x8000u / ArrivingLight::kSide; };
    return decode_octahedral(code(cell % ArrivingLight::kSide) | code(cell / ArrivingLight::kSide) << 16);
}

}  // namespace

ArrivingLight::ArrivingLight(std::shared_ptr<const PathsBake> bake) : bake_(std::move(bake)) {
    for (uint32_t cell = 0; cell < kCells; ++cell) directions_[cell] = middle_of(cell);
    const LightPaths& paths = bake_->paths;
    cell_of_.resize(paths.points.size() * paths.rays_a_point);
    rays_in_.resize(paths.points.size() * kCells);
    parallel_ranges(paths.points.size(), kPointsATask, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const GatheringPoint& point = paths.points[i];
            const CosineDirections directions(point.normal, bake_->seed, point.side);
            for (uint32_t ray = 0; ray < paths.rays_a_point; ++ray) {
                const uint32_t cell = cell_of(directions[ray]);
                cell_of_[i * paths.rays_a_point + ray] = static_cast<uint8_t>(cell);
                uint8_t& rays = rays_in_[i * kCells + cell];
                rays += rays < 255;
            }
        }
    });
}

void ArrivingLight::set(std::span<const glm::vec3> radiosity, std::span<const glm::vec3> of_lobes,
                        const PointSky* sky, std::span<const Material> materials) {
    const LightPaths& paths = bake_->paths;
    light_.assign(paths.points.size() * kCells, glm::vec3(0.0f));
    parallel_ranges(paths.points.size(), kPointsATask, [&](size_t begin, size_t end) {
        for (size_t point = begin; point < end; ++point) {
            size_t open = 0;
            for (size_t ray = point * paths.rays_a_point; ray < (point + 1) * paths.rays_a_point; ++ray) {
                glm::vec3& light = light_[point * kCells + cell_of_[ray]];
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
    const glm::vec3 mirror = 2 * cosine * normal - to;
    const float exponent = narrowed(surface.exponent);
    glm::vec3 light(0.0f);
    float rays = 0;
    for (uint32_t cell = 0; cell < kCells; ++cell) {
        const float along = glm::dot(mirror, directions_[cell]);
        if (along <= 0 || glm::dot(normal, directions_[cell]) <= 0) continue;
        const float lobe = std::pow(along, exponent);
        if (lobe < kLeastLobe) continue;
        for (const PointShare& s : about) {
            const size_t at = s.point * size_t{kCells} + cell;
            light += s.share * lobe * light_[at];
            rays += s.share * lobe * static_cast<float>(rays_in_[at]);
        }
    }
    const glm::vec3 mean = rays > kLeastRays ? light / rays : irradiance;
    return surface.ks * albedo->at(cosine) / kPi * mean;
}

}  // namespace lucarne::gi::paths
