#pragma once

#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

namespace lucarne::gi::reference {

/// The light that the paths of one start have gathered, in two halves that share no path: every other path
/// goes to the second half. Sums of several frames add up.
struct PathSums {
    glm::dvec3 exact{0.0};  ///< light that is not sampled, summed over the frames
    glm::dvec3 halves[2] = {glm::dvec3(0.0), glm::dvec3(0.0)};
    uint64_t paths[2] = {0, 0};  ///< also those of frames in which the pixel shows no surface
    uint32_t frames = 1;
    double luminance = 0, squares = 0;  ///< sum and sum of squares of the luminances of the paths

    void add(const PathSums& other);

    glm::vec3 radiance() const;               ///< W/(sr m^2)
    glm::vec3 half_radiance(int half) const;  ///< of that half alone; of all paths if it has none
    /// Variance of the luminance of radiance(), estimated from the spread of the paths; 0 below two paths.
    float variance() const;
};

/// The mean luminance of all starts and its standard error, summed in double and in order.
struct MeanLuminance {
    double mean = 0, standard_error = 0;
};
MeanLuminance mean_luminance(std::span<const PathSums> sums);

}  // namespace lucarne::gi::reference
