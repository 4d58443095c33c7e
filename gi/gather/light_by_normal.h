#pragma once

#include <array>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

namespace lucarne::gi {

/// Light that a point receives, for normals near its own: a quadratic polynomial in the normal (x, y, z)
/// whose coefficients are colours. It gives the mean radiance, W/(sr m^2) (times pi: irradiance). gather.cl
/// makes it.
struct LightByNormal {
    /// Of 1, x, y, z, xx, yy, zz, xy, yz, zx.
    std::array<glm::vec3, 10> terms{};

    /// `normal`: a unit vector.
    glm::vec3 on(const glm::vec3& normal) const {
        const float x = normal.x, y = normal.y, z = normal.z;
        const std::array<float, 10> powers{1, x, y, z, x * x, y * y, z * z, x * y, y * z, z * x};
        glm::vec3 sum(0.0f);
        for (size_t k = 0; k < terms.size(); ++k) sum += powers[k] * terms[k];
        return glm::max(sum, 0.0f);
    }
    void add(const LightByNormal& other, float weight) {
        for (size_t k = 0; k < terms.size(); ++k) terms[k] += weight * other.terms[k];
    }
    void scale(float factor) {
        for (glm::vec3& term : terms) term *= factor;
    }
};
static_assert(sizeof(LightByNormal) == 120);

}  // namespace lucarne::gi
