#include "gi/tracing/scatter.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/shared/lobe.h"
#include "gi/tracing/light_sampling.h"

namespace lucarne::gi::tracing {
namespace {

glm::vec3 mirror(const glm::vec3& normal, const glm::vec3& out) {
    return normal * (2.0f * glm::dot(normal, out)) - out;
}

/// Returns the share of draws that take the specular lobe; negative if nothing is reflected.
float specular_share(const Reflectance& surface) {
    const float total = mean_colour(surface.kd) + surface.ks;
    return total > 0 ? surface.ks / total : -1.0f;
}

}  // namespace

glm::vec3 cosine_power_direction(const glm::vec3& axis, float exponent, const glm::dvec2& square) {
    const auto u = static_cast<float>(square.x);
    const auto phi = static_cast<float>(2 * M_PI * square.y);
    const float cosine = std::pow(1.0f - u, 1.0f / (exponent + 1.0f));
    const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
    glm::vec3 tangent, bitangent;
    frame_of(axis, tangent, bitangent);
    return glm::normalize(tangent * (sine * std::cos(phi)) + bitangent * (sine * std::sin(phi)) +
                          axis * cosine);
}

float scatter_pdf(const Reflectance& surface, const glm::vec3& normal, const glm::vec3& out,
                  const glm::vec3& in) {
    const float share = specular_share(surface), cosine = glm::dot(normal, in);
    if (share < 0 || cosine <= 0) return 0;
    float pdf = (1 - share) * cosine / kPi;
    if (share > 0) {
        const float lobe_cosine = std::clamp(glm::dot(mirror(normal, out), in), 0.0f, 1.0f);
        pdf += share * (surface.exponent + 1) / (2 * kPi) * std::pow(lobe_cosine, surface.exponent);
    }
    return pdf;
}

std::optional<Scattered> scatter(const Reflectance& surface, const glm::vec3& normal, const glm::vec3& out,
                                 Random& random) {
    const float share = specular_share(surface);
    if (share < 0) return std::nullopt;
    const bool specular = random.uniform() < share;
    const double u = random.uniform(), v = random.uniform();
    const glm::vec3 in = cosine_power_direction(specular ? mirror(normal, out) : normal,
                                                specular ? surface.exponent : 1.0f, {u, v});
    const float pdf = scatter_pdf(surface, normal, out, in);
    if (!(pdf > 0)) return std::nullopt;
    return Scattered{in, brdf(surface, normal, out, in) * (glm::dot(normal, in) / pdf), pdf};
}

}  // namespace lucarne::gi::tracing
