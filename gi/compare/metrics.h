#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <glm/vec4.hpp>

#include "gi/shared/luminance.h"
#include "io/core/error.h"

namespace lucarne::gi {

/// How a picture differs from a reference; linear radiance, w unused. With r the reference's value and m its
/// mean over pixels and channels, the relative squared error of a pixel is the mean over its channels of (a
/// - r)^2 / (r^2 + .01 m^2).
struct ImageMetrics {
    double mean_luminance = 0, reference_mean_luminance = 0;  ///< W/(sr m^2), Rec. 709 weights
    double luminance_error = 0;  ///< of the mean, relative to the reference's; 0 if both are black
    double rel_mse = 0;          ///< mean over the pixels of their relative squared errors
    double rel_mse_trimmed = 0;  ///< the same without the worst share kTrimmed of them
    double rmse = 0;             ///< root of the mean over pixels and channels of (a - r)^2, W/(sr m^2)
    double p99 = 0;              ///< 99th percentile (nearest rank) of the root of the relative squared error
    uint64_t pixels = 0, trimmed_pixels = 0;  ///< pixels compared, and those left out of rel_mse_trimmed
};

/// Share of the pixels, rounded down, that the trimmed relMSE leaves out: fireflies are few but dominate the
/// mean.
inline constexpr double kTrimmed = 0.001;

/// Compares the pixels whose mask is not 0 (all if there is no mask). m is always the mean of the whole
/// reference, so that the figures of a part and of the whole can be compared. Errors (rejected): different
/// sizes, an empty picture, an empty mask, a value that is not finite.
Result<ImageMetrics> compare_images(std::span<const glm::vec4> picture, std::span<const glm::vec4> reference,
                                    std::span<const uint8_t> mask = {});

/// relMSE against a reference r = (r1 + r2) / 2 of which two independent halves are known.
struct HalvesError {
    /// Mean of (a - r1)(a - r2) / (r^2 + .01 m^2): the reference's noise averages out of the numerator.
    /// About 6 N^2 of it remain through the denominator, where N is reference_rel_mse. May be negative if
    /// the noise is larger.
    double rel_mse = 0;
    double rel_mse_trimmed = 0;    ///< the same without the worst share kTrimmed of the pixels
    double standard_error = 0;     ///< of rel_mse, from its spread over the pixels
    double reference_rel_mse = 0;  ///< of r itself: mean of ((r1 - r2) / 2)^2 / (r^2 + .01 m^2)
};

/// Compares a picture with the mean of two halves. Errors and mask as for compare_images().
Result<HalvesError> compare_with_halves(std::span<const glm::vec4> picture, std::span<const glm::vec4> first,
                                        std::span<const glm::vec4> second,
                                        std::span<const uint8_t> mask = {});

/// Errors (rejected): some pixels are not finite; the message gives their number and the place of the first.
Result<void> check_radiance(std::span<const glm::vec4> pixels, uint32_t width, const std::string& name);

/// Returns the Rec. 709 luminance of a pixel.
inline double luminance(const glm::vec4& pixel) {
    return luminance(glm::dvec3(pixel));
}
/// Returns the mean luminance of a picture; 0 for an empty one.
double mean_luminance(std::span<const glm::vec4> picture);

/// Returns the term .01 m^2 of the relative errors.
double relative_epsilon(std::span<const glm::vec4> reference);

}  // namespace lucarne::gi
