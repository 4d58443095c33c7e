#include "gi/tracing/surfel_sampler.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/shared/brdf.h"
#include "gi/tracing/light_sampling.h"

namespace lucarne::gi::tracing {

glm::vec3 point_on_disc(const Surfel& surfel, Random& random) {
    const float r = surfel.radius * static_cast<float>(std::sqrt(random.uniform()));
    const float phi = 2 * kPi * static_cast<float>(random.uniform());
    glm::vec3 u, v;
    frame_of(surfel.normal, u, v);
    return surfel.position + u * (r * std::cos(phi)) + v * (r * std::sin(phi));
}

SurfelSampler::SurfelSampler(const SurfelTracer& surfels, std::span<const double> weights)
    : surfels_(&surfels), table_({}) {
    std::vector<double> drawn;
    for (uint32_t i = 0; i < weights.size(); ++i) {
        if (!(weights[i] > 0)) continue;
        drawn_.push_back(i);
        drawn.push_back(weights[i]);
    }
    table_ = AliasTable(drawn);
    if (table_.empty()) return;
    per_area_.resize(weights.size());
    for (const uint32_t i : drawn_) {
        const float r = surfels_->surfels()[i].radius;
        per_area_[i] = static_cast<float>(weights[i] / table_.total()) / (kPi * r * r);
    }
}

SurfelSampler::Draw SurfelSampler::draw(Random& random) const {
    const uint32_t index = drawn_[table_.draw(random)];
    const Surfel& surfel = surfels_->surfels()[index];
    return {index, point_on_disc(surfel, random)};
}

SurfelSampler::Density SurfelSampler::density(const glm::vec3& origin, const glm::vec3& direction,
                                              float begin, float end, uint32_t drawn) const {
    Density result;
    if (empty()) return result;
    surfels_->each_crossed(origin, direction, begin, end, [&](uint32_t index) {
        const Surfel& surfel = surfels_->surfels()[index];
        const float cosine = glm::dot(surfel.normal, direction);
        const float distance = glm::dot(surfel.normal, surfel.position - origin) / cosine;
        result.pdf += per_area_[index] * distance * distance / std::max(std::abs(cosine), 1e-12f);
        result.crossed |= index == drawn;
    });
    if (!std::isfinite(result.pdf)) return {};
    return result;
}

}  // namespace lucarne::gi::tracing
