#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "gi/scene/environment.h"

namespace lucarne::gi {

/// Draws directions of an environment in proportion to its luminance: even points of a square become an even
/// sample of its light.
class SkyDirections {
 public:
    /// Without an environment, or with a black one, it is dark.
    explicit SkyDirections(std::shared_ptr<const Environment> environment = nullptr);

    const std::shared_ptr<const Environment>& environment() const { return environment_; }
    bool dark() const { return !(total_ > 0); }

    struct Drawn {
        glm::vec3 direction;  ///< unit, toward the light
        glm::vec3 flux;       ///< radiance over density, W/m^2: the mean over all points is the whole sky's
    };
    /// Draws a direction for `point` in [0, 1)^2. The sky must not be dark.
    Drawn draw(const glm::dvec2& point) const;

 private:
    double weight(uint32_t x, uint32_t y) const;
    double row_weight(uint32_t first_x, uint32_t end_x, uint32_t y) const;

    std::shared_ptr<const Environment> environment_;
    // Running sums over blocks of texels, so that a large picture needs no sum a texel.
    uint32_t block_ = 1, columns_ = 0, rows_ = 0;
    std::vector<double> row_sums_;    // of rows of blocks
    std::vector<double> block_sums_;  // within each row
    double total_ = 0;                // luminance times solid angle, all of it
};

}  // namespace lucarne::gi
