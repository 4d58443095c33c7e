#pragma once

#include <glm/vec3.hpp>

#include "gi/shared/brdf.h"

namespace lucarne::gi::paths {

/// What the lobes of a surface reflect of lamps: sums that can be averaged over surfaces.
struct LampLobe {
    glm::vec3 energy{0.0f};  ///< ks times the irradiance, W/m^2
    glm::vec3 mirror{0.0f};  ///< directions into which mirrors would reflect, by luminance of energy
    float exponent = 0;      ///< likewise

    /// `to_light`: mean of the unit directions to lamps, by irradiance; shorter the more they differ.
    static LampLobe of(const Reflectance& surface, const glm::vec3& normal, const glm::vec3& to_light,
                       const glm::vec3& irradiance);
    LampLobe& operator+=(const LampLobe& other);
    LampLobe operator*(float share) const;
    LampLobe operator/(float parts) const { return *this * (1 / parts); }
};

/// The same as one lobe about the mean direction, which is wider the more directions differ: lengths of mean
/// directions multiply (that of cos^n is (n + 1) / (n + 2)).
class MeanLobe {
 public:
    MeanLobe() = default;
    /// Lobes narrower than `largest_exponent` are taken to be as wide.
    MeanLobe(const LampLobe& lobe, float largest_exponent);
    bool shines() const { return peak_ != glm::vec3(0.0f); }
    /// Returns the light that leaves towards a unit direction, as the radiosity of a diffuse surface that
    /// looks as bright from there, W/m^2.
    glm::vec3 radiosity(const glm::vec3& to) const;

 private:
    glm::vec3 peak_{0.0f}, mirror_{0.0f};
    float exponent_ = 0;
};

}  // namespace lucarne::gi::paths
