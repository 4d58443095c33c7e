#pragma once

#include <span>

#include <glm/vec4.hpp>

#include "io/core/error.h"

namespace lucarne::gi {

/// How a picture differs from the reference it is held against; linear radiance, w unused.
struct ImageMetrics {
    double mean_luminance = 0, reference_mean_luminance = 0;  ///< W/(sr m^2), Rec. 709 weights
    double luminance_error = 0;  ///< of the mean, relative to the reference's; 0 where both are black
    double rel_mse = 0;  ///< mean over pixels and channels of (a - r)^2 / (r^2 + .01 m^2), m the mean of r
    double rmse = 0;     ///< root of the mean over pixels and channels of (a - r)^2
};

/// Errors (rejected): different sizes, an empty picture, a value that is not finite.
Result<ImageMetrics> compare_images(std::span<const glm::vec4> picture, std::span<const glm::vec4> reference);

/// Mean luminance of a picture; 0 of an empty one.
double mean_luminance(std::span<const glm::vec4> picture);

}  // namespace lucarne::gi
