// Shared by the tests of the path tracer.
#pragma once

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/engines/reference/path_tracer.h"
#include "tests/gi/engines/surfel_scenes.h"

namespace lucarne::gi::reference {

inline const glm::vec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1), kO(0.0f);

inline std::unique_ptr<SurfelTracer> tracer_of(std::vector<Surfel> surfels) {
    auto tracer = SurfelTracer::create(std::move(surfels));
    EXPECT_TRUE(tracer) << tracer.error().line();
    return std::move(*tracer);
}

/// Returns n x n starts on a parallelogram, seen along its normal.
inline std::vector<Start> starts_on(const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v, int n,
                                    float radius, const glm::vec3& albedo) {
    std::vector<Start> starts;
    const glm::vec3 normal = glm::normalize(glm::cross(u, v));
    for (int i = 0; i < n * n; ++i) {
        const float a = (static_cast<float>(i % n) + .5f) / static_cast<float>(n);
        const float b = (static_cast<float>(i / n) + .5f) / static_cast<float>(n);
        starts.push_back({corner + u * a + v * b, normal, normal, albedo, radius, 0});
    }
    return starts;
}

inline Material material(float diffuse, float specular, float exponent, float emission) {
    return {glm::vec4(diffuse, diffuse, diffuse, specular),
            glm::vec4(emission, emission, emission, exponent)};
}

inline Light spot(const glm::vec3& position, const glm::vec3& target, float half_angle, float inner_angle,
                  float intensity) {
    return {glm::vec4(position, std::cos(half_angle)),
            glm::vec4(glm::normalize(target - position), std::cos(inner_angle)),
            glm::vec4(intensity, intensity, intensity, 0)};
}

inline Light point(const glm::vec3& position, float intensity) {
    return {glm::vec4(position, 0), glm::vec4(0), glm::vec4(glm::vec3(intensity), 0), glm::vec4(0),
            kPointLight};
}

inline Light rectangle_light(const glm::vec3& middle, const glm::vec3& normal, const glm::vec3& half_side,
                             float other_half, float radiance) {
    return {glm::vec4(middle, 0), glm::vec4(normal, 0), glm::vec4(glm::vec3(radiance), 0),
            glm::vec4(half_side, other_half), kRectangleLight};
}
inline Light disc_light(const glm::vec3& middle, const glm::vec3& normal, float radius, float radiance) {
    return {glm::vec4(middle, 0), glm::vec4(normal, 0), glm::vec4(glm::vec3(radiance), 0),
            glm::vec4(0, 0, 0, radius), kDiscLight};
}
inline Light sun(const glm::vec3& direction, float irradiance, float angular_radius) {
    return {glm::vec4(0), glm::vec4(glm::normalize(direction), angular_radius),
            glm::vec4(glm::vec3(irradiance), 0), glm::vec4(0), kDirectionalLight};
}

inline std::shared_ptr<const Environment> uniform_environment(float radiance) {
    auto environment = std::make_shared<Environment>();
    environment->texels = {glm::vec3(radiance)};
    return environment;
}

/// Returns the mean luminance that the tracer finds on some starts.
inline MeanLuminance traced(const Illumination& light, const std::vector<Start>& starts,
                            const PathSettings& settings) {
    return mean_luminance(PathTracer(light, settings).trace(starts));
}

}  // namespace lucarne::gi::reference
