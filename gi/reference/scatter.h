#pragma once

#include <optional>

#include <glm/vec3.hpp>

#include "gi/shared/material.h"
#include "io/core/random.h"

namespace lucarne::gi::reference {

/// The reflectance of a point: kd/pi + ks (n+2)/(2 pi) cos^n, see gi/shared/material.h.
struct Lobes {
    glm::vec3 diffuse{0.0f};  ///< kd
    float specular = 0;       ///< ks
    float exponent = 1;       ///< n
};
Lobes make_lobes(const glm::vec3& albedo, const Material& material);

/// f(out, in), 1/sr; both directions point away from the surface. 0 below the surface.
glm::vec3 evaluate(const Lobes& lobes, const glm::vec3& normal, const glm::vec3& out, const glm::vec3& in);

struct Scattered {
    glm::vec3 direction;
    glm::vec3 weight;  ///< f cos / pdf
};
/// Draws an incoming direction from the mixture of both lobes (one-sample model, Veach 1997, sec. 9.2.4: the
/// pdf of the whole mixture divides, whichever lobe was drawn). Empty where the draw falls below the surface:
/// such a path carries nothing.
std::optional<Scattered> scatter(const Lobes& lobes, const glm::vec3& normal, const glm::vec3& out,
                                 Random& random);

}  // namespace lucarne::gi::reference
