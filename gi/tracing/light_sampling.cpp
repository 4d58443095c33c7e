#include "gi/tracing/light_sampling.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <glm/geometric.hpp>

#include "gi/shared/brdf.h"
#include "gi/shared/environment.h"

namespace lucarne::gi::tracing {
namespace {

glm::vec3 xyz(const glm::vec4& v) {
    return {v.x, v.y, v.z};
}

/// A rectangle or a disc: the points middle + a * u + b * v, with a and b in [-1, 1] or in the unit disc.
struct Area {
    glm::vec3 middle, normal, u, v;
    float area;
    bool round;
};

Area area_of(const Light& light) {
    Area result{xyz(light.position), xyz(light.direction), {}, {}, 0, light.kind == kDiscLight};
    if (result.round) {
        frame_of(result.normal, result.u, result.v);
        result.u *= light.extent.w;
        result.v *= light.extent.w;
        result.area = kPi * light.extent.w * light.extent.w;
    } else {
        result.u = xyz(light.extent);
        const float half = glm::length(result.u);
        result.v = glm::cross(result.normal, result.u / half) * light.extent.w;
        result.area = 4 * half * light.extent.w;
    }
    return result;
}

/// Returns the light that arrives at `position` from the point `at` of the area.
std::optional<Incident> from_area(const Light& light, const Area& area, const glm::vec3& position,
                                  const glm::vec3& at) {
    const glm::vec3 offset = at - position;
    const float distance2 = glm::dot(offset, offset);
    if (!(distance2 > 0)) return std::nullopt;
    const float distance = std::sqrt(distance2);
    const glm::vec3 direction = offset / distance;
    const float cosine = -glm::dot(direction, area.normal);
    if (!(cosine > 0)) return std::nullopt;
    return Incident{direction, xyz(light.strength), distance2 / (cosine * area.area), distance};
}

// The cap of sky of a directional light with the angular radius a. Its solid angle is 2 pi (1 - cos a); the
// irradiance of a surface that faces its middle is pi sin^2 a times the radiance. 1 - cos a is computed as 2
// sin^2(a/2), which does not cancel for small angles.
float cap_height(const Light& light) {
    const float s = std::sin(light.direction.w / 2);
    return 2 * s * s;
}
Incident from_cap(const Light& light, const glm::vec3& direction) {
    const float sine = std::sin(light.direction.w);
    return {direction, xyz(light.strength) / (kPi * sine * sine), 1 / (2 * kPi * cap_height(light))};
}

}  // namespace

void frame_of(const glm::vec3& n, glm::vec3& tangent, glm::vec3& bitangent) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z), b = n.x * n.y * a;
    tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
}

bool is_sharp(const Light& light) {
    // Below a thousandth of a degree the cap is smaller than the directions that floats can distinguish.
    constexpr float kSmallestCap = 2e-5f;
    return light.kind == kSpotLight || light.kind == kPointLight ||
           (light.kind == kDirectionalLight && light.direction.w < kSmallestCap);
}

std::optional<Incident> sample_light(const Light& light, const glm::vec3& position, Random& random) {
    const double a = random.uniform();
    return sample_light(light, position, glm::dvec2(a, random.uniform()));
}

std::optional<Incident> sample_light(const Light& light, const glm::vec3& position,
                                     const glm::dvec2& square) {
    const auto a = static_cast<float>(square.x), b = static_cast<float>(square.y);
    if (light.kind == kDirectionalLight) {
        const float drop = a * cap_height(light);  // 1 - cosine
        const float sine = std::sqrt(std::max(0.0f, drop * (2 - drop))), phi = 2 * kPi * b;
        const glm::vec3 axis = -xyz(light.direction);
        glm::vec3 tangent, bitangent;
        frame_of(axis, tangent, bitangent);
        return from_cap(light, glm::normalize(tangent * (sine * std::cos(phi)) +
                                              bitangent * (sine * std::sin(phi)) + axis * (1 - drop)));
    }
    const Area area = area_of(light);
    if (area.round) {
        const float r = std::sqrt(a), phi = 2 * kPi * b;
        return from_area(light, area, position,
                         area.middle + area.u * (r * std::cos(phi)) + area.v * (r * std::sin(phi)));
    }
    return from_area(light, area, position, area.middle + area.u * (2 * a - 1) + area.v * (2 * b - 1));
}

std::optional<Incident> light_along(const Light& light, const glm::vec3& position,
                                    const glm::vec3& direction) {
    if (light.kind == kDirectionalLight) {
        const glm::vec3 apart = direction + xyz(light.direction);  // |apart|^2 = 2 (1 - cosine)
        if (glm::dot(apart, apart) > 2 * cap_height(light)) return std::nullopt;
        return from_cap(light, direction);
    }
    const Area area = area_of(light);
    const float cosine = -glm::dot(direction, area.normal);
    if (!(cosine > 0)) return std::nullopt;
    const float distance = glm::dot(position - area.middle, area.normal) / cosine;
    if (!(distance > 0)) return std::nullopt;
    const glm::vec3 at = position + direction * distance, offset = at - area.middle;
    const float x = glm::dot(offset, area.u) / glm::dot(area.u, area.u);
    const float y = glm::dot(offset, area.v) / glm::dot(area.v, area.v);
    if (area.round ? x * x + y * y > 1 : std::max(std::abs(x), std::abs(y)) > 1) return std::nullopt;
    return from_area(light, area, position, at);
}

namespace {

double row_solid_angle(const Environment& environment, size_t row) {
    const double step = M_PI / environment.height;
    const auto y = static_cast<double>(row);
    return 2 * M_PI / environment.width * (std::cos(y * step) - std::cos((y + 1) * step));
}

std::vector<double> texel_weights(const Environment& environment) {
    std::vector<double> weights(environment.texels.size());
    for (size_t y = 0; y < environment.height; ++y) {
        const double solid_angle = row_solid_angle(environment, y);
        for (size_t i = y * environment.width; i < (y + 1) * environment.width; ++i)
            weights[i] = luminance(environment.texels[i]) * solid_angle;
    }
    return weights;
}

}  // namespace

EnvironmentSampler::EnvironmentSampler(std::shared_ptr<const Environment> environment)
    : environment_(std::move(environment)), table_(texel_weights(*environment_)) {}

Incident EnvironmentSampler::incident(const glm::vec3& direction, size_t texel) const {
    const glm::vec3& radiance = environment_->texels[texel];
    // Weight over total is the probability of the texel; within it directions are evenly distributed.
    const double pdf = table_.empty() ? 0 : luminance(radiance) / table_.total();
    return {direction, radiance, static_cast<float>(pdf)};
}

Incident EnvironmentSampler::sample(Random& random) const {
    const uint32_t texel = table_.draw(random);
    const size_t x = texel % environment_->width, y = texel / environment_->width;
    const double step = M_PI / environment_->height;
    const double top = std::cos(static_cast<double>(y) * step),
                 low = std::cos((static_cast<double>(y) + 1) * step);
    const double z = top + (low - top) * random.uniform(), sine = std::sqrt(std::max(0.0, 1 - z * z));
    const double u = (static_cast<double>(x) + random.uniform()) / environment_->width;
    const double turns = 2 * M_PI * (u - .5) - environment_->rotation;  // from +y to +x
    return incident(glm::vec3(sine * std::sin(turns), sine * std::cos(turns), z), texel);
}

Incident EnvironmentSampler::along(const glm::vec3& direction) const {
    return incident(direction, environment_->texel(direction));
}

}  // namespace lucarne::gi::tracing
