#pragma once

#include <limits>
#include <memory>
#include <optional>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "gi/scene/environment.h"
#include "gi/shared/light.h"
#include "gi/shared/luminance.h"
#include "gi/tracing/alias_table.h"
#include "io/core/random.h"

namespace lucarne::gi::tracing {

/// Light that would arrive at a point from one direction if nothing blocked it.
struct Incident {
    glm::vec3 direction;  ///< unit, toward the light
    glm::vec3 radiance;   ///< W/(sr m^2)
    float pdf = 0;        ///< density, 1/sr, with which sampling the light draws the direction
    float distance = std::numeric_limits<float>::infinity();
};

/// Returns whether the light comes from a single direction (then light_irradiance() computes it). Other
/// lights have to be sampled.
bool is_sharp(const Light& light);

/// Returns the direction of a light that is not sharp which belongs to a point of the unit square: even
/// points are even over its area or cap. Returns none if its dark side faces the position.
std::optional<Incident> sample_light(const Light& light, const glm::vec3& position, const glm::dvec2& square);
std::optional<Incident> sample_light(const Light& light, const glm::vec3& position, Random& random);
/// Returns the light that such a light sends along a given direction, with the density of sample_light() for
/// it.
std::optional<Incident> light_along(const Light& light, const glm::vec3& position,
                                    const glm::vec3& direction);

/// Draws directions of an environment in proportion to luminance.
class EnvironmentSampler {
 public:
    explicit EnvironmentSampler(std::shared_ptr<const Environment> environment);

    bool dark() const { return table_.empty(); }
    Incident sample(Random& random) const;  ///< the environment must not be dark
    Incident along(const glm::vec3& direction) const;

 private:
    Incident incident(const glm::vec3& direction, size_t texel) const;

    std::shared_ptr<const Environment> environment_;
    AliasTable table_;
};

/// Computes two unit vectors that make a right-handed frame with the unit vector n (Duff et al. 2017).
void frame_of(const glm::vec3& n, glm::vec3& tangent, glm::vec3& bitangent);

}  // namespace lucarne::gi::tracing
