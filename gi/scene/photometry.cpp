#include "gi/scene/photometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace lucarne::gi {
namespace {

constexpr double kPi = std::numbers::pi;

/// Returns the power of a light of strength [1, 1, 1], W; for directional lights W/m^2.
double watts(const SceneLight& light, double metres_per_unit) {
    const double area = metres_per_unit * metres_per_unit;
    switch (light.kind) {
        case LightKind::spot: {
            // The edge fades as the smoothstep of the cosine, whose mean is a half.
            const double half = light.angle / 2, inner = half * (1 - light.softness);
            return 2 * kPi * (1 - (std::cos(inner) + std::cos(half)) / 2);
        }
        case LightKind::point:
            return 4 * kPi;
        case LightKind::directional:
            return 1;
        case LightKind::rectangle:
            return kPi * light.width * light.height * area;
        case LightKind::disc:
            return kPi * kPi * light.radius * light.radius * area;
    }
    return 0;
}

}  // namespace

double luminous_flux(const SceneLight& light, double metres_per_unit) {
    return kLumensPerWatt * luminance(light.strength) * watts(light, metres_per_unit);
}

void set_luminous_flux(SceneLight& light, double lumens, double metres_per_unit) {
    const double now = luminous_flux(light, metres_per_unit);
    if (now > 0)
        light.strength *= lumens / now;
    else
        light.strength = glm::dvec3(lumens / (kLumensPerWatt * watts(light, metres_per_unit)));
}

glm::dvec3 rec709_of(const glm::dvec3& xyz) {
    return {glm::dot(xyz, glm::dvec3(3.2404542, -1.5371385, -0.4985314)),
            glm::dot(xyz, glm::dvec3(-0.9692660, 1.8760108, 0.0415560)),
            glm::dot(xyz, glm::dvec3(0.0556434, -0.2040259, 1.0572252))};
}

glm::dvec3 black_body_colour(double kelvin) {
    const double t = std::clamp(kelvin, kCoolest, kHottest), k = 1000 / t;
    const double x = t <= 4000 ? ((-0.2661239 * k - 0.2343589) * k + 0.8776956) * k + 0.179910
                               : ((-3.0258469 * k + 2.1070379) * k + 0.2226347) * k + 0.240390;
    const double y = t <= 2222   ? ((-1.1063814 * x - 1.34811020) * x + 2.18555832) * x - 0.20219683
                     : t <= 4000 ? ((-0.9549476 * x - 1.37418593) * x + 2.09137015) * x - 0.16748867
                                 : ((3.0817580 * x - 5.87338670) * x + 3.75112997) * x - 0.37001483;
    const glm::dvec3 shown = glm::max(rec709_of({x / y, 1, (1 - x - y) / y}), 0.0);
    return shown / std::max({shown.x, shown.y, shown.z});
}

double black_body_temperature(const glm::dvec3& colour) {
    double low = kCoolest, high = kHottest;
    for (int step = 0; step < 40; ++step) {
        const double middle = (low + high) / 2;
        const glm::dvec3 body = black_body_colour(middle);
        (body.z * colour.x < colour.z * body.x ? low : high) = middle;  // hotter bodies are bluer
    }
    return high;
}

}  // namespace lucarne::gi
