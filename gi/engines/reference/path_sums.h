#pragma once

#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

namespace lucarne::gi::reference {

/// What the paths of one start have gathered, in two halves that share no path: every other path goes to the
/// second. Sums of several frames add up.
struct PathSums {
    glm::dvec3 exact{0.0};  ///< light without chance in it, the same for every path
    glm::dvec3 halves[2] = {glm::dvec3(0.0), glm::dvec3(0.0)};
    uint64_t paths[2] = {0, 0};
    double luminance = 0, squares = 0;  ///< of the paths' light: sum, and sum of squares

    void add(const PathSums& other);

    glm::vec3 radiance() const;               ///< W/(sr m^2)
    glm::vec3 half_radiance(int half) const;  ///< by that half alone; of all paths where it has none
    /// Of the luminance of radiance(), estimated from the spread of the paths; 0 below two paths.
    float variance() const;
};

/// Mean luminance of all starts and its standard error, in double and in order.
struct MeanLuminance {
    double mean = 0, standard_error = 0;
};
MeanLuminance mean_luminance(std::span<const PathSums> sums);

}  // namespace lucarne::gi::reference
