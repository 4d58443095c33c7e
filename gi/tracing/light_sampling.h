#pragma once

#include <limits>
#include <memory>
#include <optional>

#include <glm/vec3.hpp>

#include "gi/scene/environment.h"
#include "gi/shared/light.h"
#include "gi/shared/luminance.h"
#include "gi/tracing/alias_table.h"
#include "io/core/random.h"

namespace lucarne::gi::tracing {

/// Light that would arrive at a point from one direction, were nothing in the way.
struct Incident {
    glm::vec3 direction;  ///< unit, toward the light
    glm::vec3 radiance;   ///< W/(sr m^2)
    float pdf = 0;        ///< with which sampling the light draws the direction, 1/sr
    float distance = std::numeric_limits<float>::infinity();
};

/// Whether light comes from a single direction (light_irradiance() knows it); the others have to be sampled.
bool is_sharp(const Light& light);

/// A direction of a light that is not sharp, evenly over its area or cap. Empty where it shows its dark side.
std::optional<Incident> sample_light(const Light& light, const glm::vec3& position, Random& random);
/// What such a light sends along a given direction, and how likely sample_light() is to draw that.
std::optional<Incident> light_along(const Light& light, const glm::vec3& position,
                                    const glm::vec3& direction);

/// Draws directions of an environment in proportion to luminance.
class EnvironmentSampler {
 public:
    explicit EnvironmentSampler(std::shared_ptr<const Environment> environment);

    bool dark() const { return table_.empty(); }
    Incident sample(Random& random) const;  ///< of one that is not dark
    Incident along(const glm::vec3& direction) const;

 private:
    Incident incident(const glm::vec3& direction, size_t texel) const;

    std::shared_ptr<const Environment> environment_;
    AliasTable table_;
};

/// Two unit vectors that make a right-handed frame with the unit vector n (Duff et al. 2017).
void frame_of(const glm::vec3& n, glm::vec3& tangent, glm::vec3& bitangent);

}  // namespace lucarne::gi::tracing
