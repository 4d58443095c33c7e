#include "gi/tracing/illumination.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "gi/lighting/direct_light.h"
#include "gi/shared/brdf.h"
#include "io/core/parallel.h"

namespace lucarne::gi::tracing {
namespace {

constexpr uint64_t kProbes = 0x6c6974;  // seed of the probes' points

glm::vec3 emission_of(const Material& material) {
    return {material.emission.x, material.emission.y, material.emission.z};
}

}  // namespace

Illumination::Illumination(const SurfelTracer& surfels, std::vector<Material> materials,
                           std::vector<Light> lights, std::shared_ptr<const Environment> environment)
    : surfels_(surfels),
      materials_(device_materials(std::move(materials))),
      emitters_(surfels, {}),
      lit_(surfels, {}) {
    std::ranges::partition_copy(lights, std::back_inserter(sharp_), std::back_inserter(soft_), is_sharp);
    if (environment) environment_.emplace(std::move(environment));
    if (environment_ && environment_->dark()) environment_.reset();
    if (std::ranges::any_of(materials_, [](const Material& m) { return luminance(emission_of(m)) > 0; }))
        emitters_ = sampler_of([&](uint32_t surfel) { return emitted(surfel); });
    if (!sharp_.empty()) lit_ = sampler_of([&](uint32_t surfel) { return lit(surfel); });
}

SurfelSampler Illumination::sampler_of(const std::function<double(uint32_t)>& weight) const {
    std::vector<double> weights(surfels_.surfels().size());
    parallel_ranges(weights.size(), 4096, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const double w = weight(static_cast<uint32_t>(i));
            weights[i] = w > 0 && std::isfinite(w) ? w : 0;
        }
    });
    return {surfels_, weights};
}

const Material& Illumination::material(uint32_t index) const {
    return materials_[std::min<size_t>(index, materials_.size() - 1)];
}

bool Illumination::arrives(const Light& sharp, const glm::vec3& origin, const glm::vec3& in) const {
    return sharp.kind == kDirectionalLight ? !surfels_.occluded_along(origin, in)
                                           : !surfels_.occluded(origin, glm::vec3(sharp.position));
}

double Illumination::emitted(uint32_t index) const {
    const Surfel& surfel = surfels_.surfels()[index];
    return static_cast<double>(luminance(emission_of(material(surfel.material)))) * surfel.area;
}

/// Returns the light, from all sharp lights, that a surfel reflects. It is probed at one point of the surfel
/// for one light, so that a surfel costs one ray. With several lights one is chosen in proportion to its
/// unshadowed effect.
double Illumination::lit(uint32_t index) const {
    const Surfel& surfel = surfels_.surfels()[index];
    Random random(kProbes, index);
    const glm::vec3 point = point_on_disc(surfel, random);
    const Reflectance surface = make_reflectance(material(surfel.material), surfel.albedo);
    const float radius2 = surfel.radius * surfel.radius;
    const double area = surfel.area > 0 ? surfel.area : kPi * radius2;
    double sum = 0;
    const Light* chosen = nullptr;
    glm::vec3 origin, to_light;
    for (const Light& light : sharp_) {
        glm::vec3 in, normal = surfel.normal, irradiance = light_irradiance(light, point, normal, in);
        if (irradiance == glm::vec3(0.0f))
            irradiance = light_irradiance(light, point, normal = -normal, in);  // a disc has two sides
        double power = area * luminance(irradiance * (surface.kd + surface.ks));
        if (light.kind != kDirectionalLight) {  // close to the lamp a disc is darker than this point
            const glm::vec3 offset = glm::vec3(light.position) - point;
            const float distance2 = glm::dot(offset, offset);
            power *= distance2 / (distance2 + radius2);
        }
        if (!(power > 0)) continue;
        sum += power;
        if (random.uniform() * sum >= power) continue;
        chosen = &light;
        origin = offset_origin(point, normal, surfel.radius);
        to_light = in;
    }
    return chosen && arrives(*chosen, origin, to_light) ? sum : 0;
}

}  // namespace lucarne::gi::tracing
