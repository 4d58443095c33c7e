#include "gi/tracing/exposure.h"

#include "gi/tracing/surfel_sampler.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi::tracing {
namespace {

constexpr size_t kSurfelsATask = 4096;
/// Rays start so many radii above a disc: above the noise of its own sheet, and below other things.
constexpr float kHeight = 2;
constexpr uint64_t kExposureSeed = 0xe4705;

}  // namespace

bool is_exposed(const SurfelTracer& tracer, size_t surfel, const glm::vec3& point, const glm::vec3& normal) {
    const glm::vec3 origin = point + normal * (kHeight * tracer.surfels()[surfel].radius);
    const auto hit = tracer.first_hit(origin, -normal);
    return hit && hit->surfel == surfel;
}

std::vector<Exposure> exposures(const SurfelTracer& tracer) {
    const std::vector<Surfel>& surfels = tracer.surfels();
    std::vector<Exposure> result(surfels.size());
    parallel_ranges(surfels.size(), kSurfelsATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const Surfel& surfel = surfels[i];
            Random random(kExposureSeed, i);
            const auto seen = [&](const glm::vec3& normal) {
                uint8_t points = 0;
                for (uint32_t k = 0; k < kExposurePoints; ++k) {
                    if (is_exposed(tracer, i, point_on_disc(surfel, random), normal)) ++points;
                }
                return points;
            };
            result[i].front = seen(surfel.normal);
            result[i].back = seen(-surfel.normal);
        }
    });
    return result;
}

}  // namespace lucarne::gi::tracing
