#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <glm/vec3.hpp>

#include "io/core/error.h"

namespace lucarne::gi {

/// Light from infinitely far away in every direction, as an equirectangular picture (gi/shared/environment.h
/// says how it lies in the world). Its radiance is constant within a texel, so that what is sampled is what
/// is seen.
struct Environment {
    uint32_t width = 1, height = 1;
    std::vector<glm::vec3> texels{glm::vec3(0.0f)};  ///< W/(sr m^2), rows from the zenith down
    float rotation = 0;                              ///< about z, radians, counterclockwise from above
    std::filesystem::path image;                     ///< what was read; empty: the same from everywhere
    glm::dvec3 scale{1.0};                           ///< that the picture's values were multiplied by

    /// In a unit direction, W/(sr m^2).
    glm::vec3 radiance(const glm::vec3& direction) const { return texels[texel(direction)]; }
    /// The texel that a unit direction meets.
    size_t texel(const glm::vec3& direction) const;

    bool operator==(const Environment&) const = default;
};

/// No more texels than this: 8192 x 4096 take 384 MiB.
inline constexpr uint64_t kMostEnvironmentTexels = uint64_t{1} << 25;

/// Reads an .exr or .hdr picture (by its name) and scales it; negative values, which filters leave in
/// pictures, become 0. Errors: the reader's; too large; a texel that is no number or infinite.
Result<Environment> load_environment(const std::filesystem::path& path, const glm::dvec3& scale,
                                     double rotation);

}  // namespace lucarne::gi
