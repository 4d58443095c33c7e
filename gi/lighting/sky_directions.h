#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "gi/scene/environment.h"

namespace lucarne::gi {

/// Returns the direction at (u, v) in [0, 1)^2 of a cell of sky_grid.h, even over its solid angle.
glm::vec3 sky_direction(uint32_t cell, double u, double v);

/// Draws directions of an environment in proportion to its luminance: even points of a square become an even
/// sample of its light. In a room, most of the sky lights the roof only, so some directions can be favoured.
class SkyDirections {
 public:
    /// Without an environment, or with a black one, it is dark.
    explicit SkyDirections(std::shared_ptr<const Environment> environment = nullptr);

    const std::shared_ptr<const Environment>& environment() const { return environment_; }
    bool dark() const { return !(total_ > 0); }

    /// Draws half of the directions in proportion to luminance times the root of `importance` from now on,
    /// which has a value for each cell of sky_grid.h. The mean over all points stays that of the whole sky.
    /// Without any positive value (also: an empty span), luminance alone decides.
    void favour(std::span<const float> importance);

    struct Drawn {
        glm::vec3 direction;  ///< unit, toward the light
        glm::vec3 flux;       ///< radiance over density, W/m^2: the mean over all points is the whole sky's
    };
    /// Draws a direction for `point` in [0, 1)^2. The sky must not be dark.
    Drawn draw(const glm::dvec2& point) const;

 private:
    double weight(uint32_t x, uint32_t y) const;
    double row_weight(uint32_t first_x, uint32_t end_x, uint32_t y) const;
    glm::vec3 draw_by_luminance(const glm::dvec2& point) const;
    glm::vec3 draw_favoured(const glm::dvec2& point) const;

    std::shared_ptr<const Environment> environment_;
    // Running sums over blocks of texels, so that a large picture needs no sum a texel.
    uint32_t block_ = 1, columns_ = 0, rows_ = 0;
    std::vector<double> row_sums_;    // of rows of blocks
    std::vector<double> block_sums_;  // within each row
    double total_ = 0;                // luminance times solid angle, all of it
    std::vector<double> favoured_;    // running sums over the cells of the grid; empty: none is favoured
};

}  // namespace lucarne::gi
