#include "gi/reference/scatter.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lucarne::gi::reference {
namespace {

constexpr float kPi = 3.14159265358979f;

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

Lobes make_lobes(const glm::vec3& albedo, const Material& material) {
    const glm::vec3 scale(material.diffuse.x, material.diffuse.y, material.diffuse.z);
    Lobes lobes;
    lobes.specular = std::clamp(material.diffuse.w, 0.0f, 1.0f);
    lobes.exponent = std::max(material.emission.w, 1.0f);
    lobes.diffuse = glm::min(glm::max(albedo * scale, 0.0f), std::min(0.95f, 1.0f - lobes.specular));
    return lobes;
}

glm::vec3 evaluate(const Lobes& lobes, const glm::vec3& normal, const glm::vec3& out, const glm::vec3& in) {
    if (glm::dot(normal, in) <= 0) return glm::vec3(0.0f);
    glm::vec3 f = lobes.diffuse / kPi;
    if (lobes.specular > 0) {
        const float cosine = std::max(0.0f, glm::dot(mirror(normal, out), in));
        f += lobes.specular * (lobes.exponent + 2) / (2 * kPi) * std::pow(cosine, lobes.exponent);
    }
    return f;
}

std::optional<Scattered> scatter(const Lobes& lobes, const glm::vec3& normal, const glm::vec3& out,
                                 Random& random) {
    const float total = mean(lobes.diffuse) + lobes.specular;
    if (total <= 0) return std::nullopt;
    const float share = lobes.specular / total;  // of draws from the specular lobe
    const glm::vec3 axis = mirror(normal, out);
    const bool specular = random.uniform() < share;
    const glm::vec3 in =
        sample_cosine_power(specular ? axis : normal, specular ? lobes.exponent : 1.0f, random);
    const float cosine = glm::dot(normal, in);
    if (cosine <= 0) return std::nullopt;
    const float lobe_cosine = std::max(0.0f, glm::dot(axis, in));
    const float pdf = (1 - share) * cosine / kPi +
                      share * (lobes.exponent + 1) / (2 * kPi) * std::pow(lobe_cosine, lobes.exponent);
    if (!(pdf > 0)) return std::nullopt;
    return Scattered{in, evaluate(lobes, normal, out, in) * (cosine / pdf)};
}

}  // namespace lucarne::gi::reference
