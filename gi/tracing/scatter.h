#pragma once

#include <optional>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "gi/shared/brdf.h"
#include "io/core/random.h"

namespace lucarne::gi::tracing {

/// Returns the direction about a unit axis that belongs to a point of the unit square: even points give
/// directions whose density is (n + 1) / (2 pi) cos^n of the angle to the axis, 1/sr.
glm::vec3 cosine_power_direction(const glm::vec3& axis, float exponent, const glm::dvec2& square);

struct Scattered {
    glm::vec3 direction;
    glm::vec3 weight;  ///< f cos / pdf
    float pdf = 0;     ///< 1/sr
};

/// Draws a direction from the mixture of both lobes of the BRDF as seen from `out` (one-sample model, Veach
/// 1997, sec. 9.2.4: the density of the whole mixture divides, whichever lobe was drawn). Returns none if
/// the draw falls below the surface; such a path carries no light.
std::optional<Scattered> scatter(const Reflectance& surface, const glm::vec3& normal, const glm::vec3& out,
                                 Random& random);
/// Returns the density, 1/sr, with which scatter() draws a direction.
float scatter_pdf(const Reflectance& surface, const glm::vec3& normal, const glm::vec3& out,
                  const glm::vec3& in);

}  // namespace lucarne::gi::tracing
