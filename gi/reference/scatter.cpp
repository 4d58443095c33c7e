#include "gi/reference/scatter.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lucarne::gi::reference {
namespace {

/// Two unit vectors that make a right-handed frame with the unit vector n (Duff et al. 2017).
void frame_of(const glm::vec3& n, glm::vec3& tangent, glm::vec3& bitangent) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z), b = n.x * n.y * a;
    tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
}

/// A direction about `axis` with the density (n+1)/(2 pi) cos^n; n = 1 is cosine-weighted.
glm::vec3 sample_cosine_power(const glm::vec3& axis, float n, Random& random) {
    const auto u = static_cast<float>(random.uniform());
    const auto phi = static_cast<float>(2 * M_PI * random.uniform());
    const float cosine = std::pow(1.0f - u, 1.0f / (n + 1.0f));
    const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
    glm::vec3 tangent, bitangent;
    frame_of(axis, tangent, bitangent);
    return glm::normalize(tangent * (sine * std::cos(phi)) + bitangent * (sine * std::sin(phi)) +
                          axis * cosine);
}

glm::vec3 mirror(const glm::vec3& normal, const glm::vec3& out) {
    return normal * (2.0f * glm::dot(normal, out)) - out;
}

float mean(const glm::vec3& v) {
    return (v.x + v.y + v.z) / 3.0f;
}

}  // namespace

std::optional<Scattered> scatter(const Reflectance& surface, const glm::vec3& normal, const glm::vec3& out,
                                 Random& random) {
    const float total = mean(surface.kd) + surface.ks;
    if (total <= 0) return std::nullopt;
    const float share = surface.ks / total;  // of draws from the specular lobe
    const glm::vec3 axis = mirror(normal, out);
    const bool specular = random.uniform() < share;
    const glm::vec3 in =
        sample_cosine_power(specular ? axis : normal, specular ? surface.exponent : 1.0f, random);
    const float cosine = glm::dot(normal, in);
    if (cosine <= 0) return std::nullopt;
    const float lobe_cosine = std::max(0.0f, glm::dot(axis, in));
    const float pdf = (1 - share) * cosine / kPi +
                      share * (surface.exponent + 1) / (2 * kPi) * std::pow(lobe_cosine, surface.exponent);
    if (!(pdf > 0)) return std::nullopt;
    return Scattered{in, brdf(surface, normal, out, in) * (cosine / pdf)};
}

}  // namespace lucarne::gi::reference
