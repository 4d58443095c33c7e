#include "gi/gather/vpl_exchange.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <glm/geometric.hpp>

#include "gi/gather/vpls.h"
#include "gi/shared/lobe.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace {

constexpr size_t kSurfelsATask = 1024;
constexpr double kGoldenRatio = 0.6180339887498949;

/// Returns what comes to the front and the back of a surfel of every `stride`-th VPL from `first` on.
std::array<Arrived, 2> arrived(const tracing::SurfelTracer& tracer, const Surfel& surfel,
                               std::span<const VirtualLight> vpls, size_t first, size_t stride) {
    std::array<Arrived, 2> sum;
    for (size_t i = first; i < vpls.size(); i += stride) {
        const VirtualLight& vpl = vpls[i];
        const glm::vec3 offset = surfel.position - vpl.position;
        const bool back = glm::dot(surfel.normal, offset) > 0;
        const glm::vec3 normal = back ? -surfel.normal : surfel.normal;
        const glm::vec3 irradiance = irradiance_by(vpl, surfel.position, normal, surfel.radius);
        if (!(mean_colour(irradiance) > 0)) continue;
        const glm::vec3 origin = tracing::offset_origin(surfel.position, normal, surfel.radius);
        if (tracer.occluded(origin, vpl.origin)) continue;
        Arrived& side = sum[back ? 1 : 0];
        side.irradiance += irradiance;
        side.directions += mean_colour(irradiance) * glm::reflect(glm::normalize(offset), normal);
    }
    for (Arrived& side : sum) {
        side.irradiance *= static_cast<float>(stride);
        side.directions *= static_cast<float>(stride);
    }
    return sum;
}

void add(const std::vector<SideLight>& more, std::vector<SideLight>& sum) {
    for (size_t i = 0; i < sum.size(); ++i) {
        sum[i].front += more[i].front;
        sum[i].back += more[i].back;
    }
}

}  // namespace

void add_light_of_vpls(const TracedTree& traced, std::span<const Material> materials,
                       const ExchangeSettings& settings, std::vector<SideLight>& light, SideLobes& lobes,
                       const std::atomic<bool>* stop) {
    const std::vector<Surfel>& surfels = traced.tracer->surfels();
    std::vector<SideLight> from = light;
    SideLobes from_lobes = lobes;
    if (settings.only_last) clear_light(light, lobes);
    for (uint32_t bounce = 1; bounce <= settings.bounces; ++bounce) {
        const std::vector<VirtualLight> vpls =
            place_vpls(traced, from, from_lobes, settings.sources, mix64(settings.seed, bounce));
        clear_light(from, from_lobes);
        const size_t stride = std::max<size_t>(vpls.size() / kVplsOfASurfel, 1);
        parallel_ranges(surfels.size(), kSurfelsATask, [&](size_t first, size_t last) {
            if (stop && *stop) return;
            for (size_t i = first; i < last; ++i) {
                // Neighbours in the tree take different ones.
                const double turn = static_cast<double>(i) * kGoldenRatio;
                const auto start =
                    static_cast<size_t>((turn - std::floor(turn)) * static_cast<double>(stride));
                const std::array<Arrived, 2> sides =
                    arrived(*traced.tracer, surfels[i], vpls, std::min(start, stride - 1), stride);
                const Reflectance r =
                    make_reflectance(materials[surfels[i].material % materials.size()], surfels[i].albedo);
                for (const bool back : {false, true})
                    add_reflected(r, sides[back ? 1 : 0], traced.surfel_of[i], back, from, from_lobes);
            }
        });
        if (stop && *stop) return;
        if (settings.only_last && bounce < settings.bounces) continue;
        add(from, light);
        add(from_lobes.light, lobes.light);
        add(from_lobes.directions, lobes.directions);
    }
}

}  // namespace lucarne::gi
