#include "gi/engines/paths/group_lobes.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/shared/luminance.h"

namespace lucarne::gi::paths {

LampLobe LampLobe::of(const Reflectance& surface, const glm::vec3& normal, const glm::vec3& to_light,
                      const glm::vec3& irradiance) {
    const glm::vec3 energy = surface.ks * irradiance;
    const float weight = luminance(energy);
    const glm::vec3 mirror = 2 * glm::dot(normal, to_light) * normal - to_light;
    return {energy, weight * mirror, weight * surface.exponent};
}

LampLobe& LampLobe::operator+=(const LampLobe& other) {
    energy += other.energy;
    mirror += other.mirror;
    exponent += other.exponent;
    return *this;
}

LampLobe LampLobe::operator*(float share) const {
    return {share * energy, share * mirror, share * exponent};
}

MeanLobe::MeanLobe(const LampLobe& lobe, float largest_exponent) {
    const float weight = luminance(lobe.energy), length = glm::length(lobe.mirror);
    if (!(weight > 0) || !(length > 0)) return;
    mirror_ = lobe.mirror / length;
    const float exponent = lobe.exponent / weight;
    const float mean = std::min(length / weight, 1.0f) * (exponent + 1) / (exponent + 2);
    exponent_ = mean < 1 ? std::clamp((2 * mean - 1) / (1 - mean), 0.0f, largest_exponent) : largest_exponent;
    peak_ = (exponent_ + 2) / 2 * lobe.energy;  // pi times that of specular_brdf()
}

glm::vec3 MeanLobe::radiosity(const glm::vec3& to) const {
    const float cosine = glm::dot(mirror_, to);
    return cosine > 0 ? std::pow(cosine, exponent_) * peak_ : glm::vec3(0.0f);
}

}  // namespace lucarne::gi::paths
