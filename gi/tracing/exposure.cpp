#include "gi/tracing/exposure.h"

#include "gi/tracing/surfel_sampler.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi::tracing {
namespace {

constexpr size_t kSurfelsATask = 4096;
/// Rays start so many radii above a disc: above the noise of its own sheet, and below other things.
constexpr float kHeight = 2, kFarthest = 1.01f * kHeight;
constexpr uint64_t kExposureSeed = 0xe4705;

/// Where rays start above a point of the disc of a surfel.
glm::vec3 above(const Surfel& surfel, const glm::vec3& point, const glm::vec3& normal) {
    return point + normal * (kHeight * surfel.radius);
}

/// Returns whether nothing is between a point of a disc and its middle. Discs of a wall's foot reach through
/// it.
bool is_this_side(const SurfelTracer& tracer, const Surfel& surfel, const glm::vec3& point,
                  const glm::vec3& normal) {
    return !tracer.occluded(above(surfel, surfel.position, normal), above(surfel, point, normal));
}

}  // namespace

bool is_exposed(const SurfelTracer& tracer, size_t surfel, const glm::vec3& point, const glm::vec3& normal) {
    const Surfel& disc = tracer.surfels()[surfel];
    const auto hit = tracer.first_hit(above(disc, point, normal), -normal);
    return hit && hit->surfel == surfel && is_this_side(tracer, disc, point, normal);
}

std::vector<Exposures> exposures(const SurfelTracer& tracer, const std::atomic<bool>* stop) {
    const std::vector<Surfel>& surfels = tracer.surfels();
    std::vector<Exposures> result(surfels.size());
    parallel_ranges(surfels.size(), kSurfelsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last && !(stop && *stop); ++i) {
            const Surfel& surfel = surfels[i];
            Random random(kExposureSeed, i);
            const auto seen = [&](const glm::vec3& normal) {
                Exposure exposure;
                for (uint32_t k = 0; k < kExposurePoints; ++k) {
                    const glm::vec3 point = point_on_disc(surfel, random);
                    const auto hit = tracer.first_hit(above(surfel, point, normal), -normal);
                    // Rays pass beyond the disc's line.
                    if (!hit || hit->distance > kFarthest * surfel.radius) continue;
                    if (hit->surfel != i)
                        exposure.cover = 2 * hit->surfel + (hit->back ? 1 : 0);
                    else if (is_this_side(tracer, surfel, point, normal))
                        ++exposure.points;
                }
                return exposure;
            };
            result[i].front = seen(surfel.normal);
            result[i].back = seen(-surfel.normal);
        }
    });
    return result;
}

}  // namespace lucarne::gi::tracing
