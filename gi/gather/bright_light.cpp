#include "gi/gather/bright_light.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/shared/brdf.h"
#include "gi/shared/lobe.h"
#include "io/core/parallel.h"
#include "io/core/random.h"

namespace lucarne::gi {
namespace {

constexpr uint64_t kCandidates = 4096, kVpls = 1024;
constexpr size_t kVplsOfAPoint = 64, kCandidatesATask = 64;
/// Share of the VPLs that is drawn by their light alone, so that what no pilot sees has its VPLs, too.
constexpr double kByLight = 0.1;
/// The most that a VPL of mean power may bring to a point, over what is typical.
constexpr float kMostOfAVpl = 1.0f;

/// Returns what of a radiance is brighter than `most`.
glm::vec3 excess_of(const glm::vec3& radiance, float most) {
    const float mean = mean_colour(radiance);
    return mean > most ? radiance * (1 - most / mean) : glm::vec3(0.0f);
}

/// Returns what a VPL that nothing hides brings to a point: irradiance, W/m^2.
glm::vec3 far_irradiance(const VirtualLight& vpl, const GatherPoint& point, float reach2) {
    const glm::vec3 offset = point.position - vpl.position;
    const float distance2 = glm::dot(offset, offset);
    return irradiance_by(vpl, point.position, point.normal, point.lift) * (distance2 / (distance2 + reach2));
}

}  // namespace

BrightLight BrightLight::find(const LitTree& scene, const TracedTree& traced,
                              std::span<const SideLight> slots, std::span<const GatherPoint> pilots,
                              float typical, uint64_t seed, const std::atomic<bool>* stop) {
    BrightLight found;
    const SurfelTree& tree = scene.tree();
    std::vector<SideLight> bright(scene.surfels().size());
    const float most = kBright * typical;
    for (size_t slot = 0; slot < tree.surfels.size(); ++slot)
        if (tree.surfels[slot] != kNoSurfel)
            bright[tree.surfels[slot]] = {excess_of(slots[slot].front, most),
                                          excess_of(slots[slot].back, most)};
    const std::vector<VirtualLight> candidates = place_vpls(traced, bright, {}, kCandidates, seed);
    if (candidates.empty() || pilots.empty() || (stop && *stop)) return found;

    std::vector<glm::vec3> starts;
    for (const GatherPoint& pilot : pilots) starts.push_back(ray_start(*traced.tracer, pilot));
    std::vector<double> brought(candidates.size());
    parallel_ranges(candidates.size(), kCandidatesATask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last && !(stop && *stop); ++i)
            for (size_t k = 0; k < pilots.size(); ++k) {
                const float light = mean_colour(far_irradiance(candidates[i], pilots[k], 0));
                if (light > 0 && !traced.tracer->occluded(starts[k], candidates[i].origin))
                    brought[i] += light;
            }
    });
    double all = 0;
    for (const double light : brought) all += light;
    if (!(all > 0) || (stop && *stop)) return found;

    // Systematic draws in the order of the tree.
    const auto count = static_cast<double>(candidates.size());
    const uint64_t wanted = kVpls;
    Random random(seed, candidates.size());
    const double shift = random.uniform();
    double power = 0, sum = 0;
    uint64_t next = 0;
    for (size_t i = 0; i < candidates.size(); ++i) {
        const double probability = kByLight / count + (1 - kByLight) * brought[i] / all;
        sum += probability;
        for (; next < wanted && (static_cast<double>(next) + shift) / static_cast<double>(wanted) < sum;
             ++next) {
            VirtualLight vpl = candidates[i];
            vpl.radius2 *= static_cast<float>(1 / (probability * static_cast<double>(wanted)));
            found.vpls_.push_back(vpl);
        }
        // The mean power of VPLs, by what they bring.
        power += brought[i] / all * mean_colour(candidates[i].even) * kPi * candidates[i].radius2 /
                 (probability * static_cast<double>(wanted));
    }
    const double weight = static_cast<double>(found.vpls_.size()) / kVplsOfAPoint;
    found.reach2_ = static_cast<float>(weight * power / (kMostOfAVpl * kPi * typical));
    found.traced_ = &traced;
    found.excess_ = shared(pull_light(tree, bright));
    return found;
}

glm::vec3 BrightLight::at(const GatherPoint& point, uint64_t number) const {
    glm::vec3 sum(0.0f);
    each(point, number, [&](const glm::vec3&, const glm::vec3& light) { sum += light; });
    return sum;
}

void BrightLight::each(const GatherPoint& point, uint64_t number,
                       const std::function<void(const glm::vec3&, const glm::vec3&)>& visit) const {
    const size_t stride = std::max<size_t>(vpls_.size() / kVplsOfAPoint, 1);
    glm::vec3 start(0.0f);
    bool started = false;
    for (size_t i = number % stride; i < vpls_.size(); i += stride) {
        const glm::vec3 irradiance = far_irradiance(vpls_[i], point, reach2_);
        if (!(mean_colour(irradiance) > 0)) continue;
        if (!started) start = ray_start(*traced_->tracer, point);
        started = true;
        if (!traced_->tracer->occluded(start, vpls_[i].origin))
            visit(glm::normalize(vpls_[i].position - point.position),
                  irradiance * (static_cast<float>(stride) / kPi));
    }
}

}  // namespace lucarne::gi
