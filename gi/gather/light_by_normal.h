#pragma once

#include <algorithm>
#include <array>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
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
    /// Adds light from one direction that a surface with the normal `normal` receives, W/(sr m^2).
    void add_ray(const glm::vec3& normal, const glm::vec3& direction, const glm::vec3& light);
    void add(const LightByNormal& other, float weight) {
        for (size_t k = 0; k < terms.size(); ++k) terms[k] += weight * other.terms[k];
    }
    void scale(float factor) {
        for (glm::vec3& term : terms) term *= factor;
    }
};
static_assert(sizeof(LightByNormal) == 120);

/// Returns light from one direction of which a surface with the normal `normal` receives `light`. Terms as in
/// the kernel `shade` of gather.cl.
inline LightByNormal light_from(const glm::vec3& direction, const glm::vec3& normal, const glm::vec3& light) {
    const glm::vec3 &d = direction, &n = normal;
    const glm::vec3 weighted = light / std::max(glm::dot(d, n), 0.1f);
    const glm::vec3 linear = 0.5f * weighted, squares = 0.46875f * weighted;
    LightByNormal result{{glm::vec3(0.0f), linear * d.x, linear * d.y, linear * d.z, squares * (d.x * d.x),
                          squares * (d.y * d.y), squares * (d.z * d.z), squares * (2 * d.x * d.y),
                          squares * (2 * d.y * d.z), squares * (2 * d.z * d.x)}};
    const std::array<float, 10> powers{0,         n.x,       n.y,       n.z,       n.x * n.x,
                                       n.y * n.y, n.z * n.z, n.x * n.y, n.y * n.z, n.z * n.x};
    result.terms[0] = light;
    for (size_t k = 1; k < powers.size(); ++k) result.terms[0] -= powers[k] * result.terms[k];
    return result;
}

inline void LightByNormal::add_ray(const glm::vec3& normal, const glm::vec3& direction,
                                   const glm::vec3& light) {
    add(light_from(direction, normal, light), 1);
}

}  // namespace lucarne::gi
