// Shared by the tests of the path tracer.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/engines/reference/path_tracer.h"
#include "tests/gi/engines/surfel_scenes.h"
#include "tests/gi/engines/test_lights.h"

namespace lucarne::gi::reference {

using scenes::disc_light, scenes::even_sky, scenes::material, scenes::point, scenes::rectangle_light,
    scenes::spot, scenes::wide_sun;

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

/// Returns the mean luminance that the tracer finds on some starts.
inline MeanLuminance traced(const Illumination& light, const std::vector<Start>& starts,
                            const PathSettings& settings) {
    return mean_luminance(PathTracer(light, settings).trace(starts));
}

}  // namespace lucarne::gi::reference
