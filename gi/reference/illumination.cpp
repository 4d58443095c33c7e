#include "gi/reference/illumination.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "gi/shared/brdf.h"

namespace lucarne::gi::reference {
namespace {

glm::vec3 emission_of(const Material& material) {
    return {material.emission.x, material.emission.y, material.emission.z};
}

}  // namespace

Illumination::Illumination(const SurfelTracer& surfels, std::vector<Material> materials,
                           std::vector<Light> lights, std::shared_ptr<const Environment> environment)
    : surfels_(surfels), materials_(std::move(materials)), emitters_({}) {
    std::ranges::partition_copy(lights, std::back_inserter(sharp_), std::back_inserter(soft_), is_sharp);
    if (environment) environment_.emplace(std::move(environment));
    if (environment_ && environment_->dark()) environment_.reset();
    if (std::ranges::none_of(materials_, [](const Material& m) { return luminance(emission_of(m)) > 0; }))
        return;
    std::vector<double> weights;
    const auto& all = surfels_.surfels();
    for (uint32_t i = 0; i < all.size(); ++i) {
        const double weight = emitted(all[i]);
        if (!(weight > 0)) continue;
        emitting_.push_back(i);
        weights.push_back(weight);
    }
    emitters_ = AliasTable(weights);
}

const Material& Illumination::material(uint32_t index) const {
    static const Material plain{glm::vec4(1, 1, 1, 0), glm::vec4(0, 0, 0, 1)};
    return index < materials_.size() ? materials_[index] : plain;
}

double Illumination::emitted(const Surfel& surfel) const {
    const double weight =
        static_cast<double>(luminance(emission_of(material(surfel.material)))) * surfel.area;
    return weight > 0 && std::isfinite(weight) ? weight : 0;
}

Illumination::Emitter Illumination::sample_emitter(Random& random) const {
    const uint32_t index = emitting_[emitters_.draw(random)];
    const Surfel& surfel = surfels_.surfels()[index];
    const float r = surfel.radius * static_cast<float>(std::sqrt(random.uniform()));
    const float phi = 2 * kPi * static_cast<float>(random.uniform());
    glm::vec3 u, v;
    frame_of(surfel.normal, u, v);
    return {index, surfel.position + u * (r * std::cos(phi)) + v * (r * std::sin(phi))};
}

float Illumination::emitter_pdf(const Surfel& surfel, float distance, float cosine) const {
    if (emitters_.empty()) return 0;
    const double per_area = emitted(surfel) / emitters_.total() / (kPi * surfel.radius * surfel.radius);
    return static_cast<float>(per_area * distance * distance / std::max(cosine, 1e-12f));
}

}  // namespace lucarne::gi::reference
