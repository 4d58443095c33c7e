#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "io/core/error.h"

namespace lucarne::gi {

/// What a sky of the daylight model is computed from (gi/scene/sky_model.h).
struct SkySettings {
    glm::dvec3 sun{0.0, 0.0, 1.0};  ///< unit direction to the sun
    double turbidity = 3;           ///< haze: 2 very clear, 3 clear, 6 hazy, 10 like thin fog
    double ground = .2;             ///< albedo of the ground, which fills the lower half

    bool operator==(const SkySettings&) const = default;
};

/// Light from infinitely far away in every direction, as an equirectangular picture (gi/shared/environment.h
/// defines its orientation). Its radiance is constant within a texel, so that sampling it and looking it up
/// agree.
struct Environment {
    uint32_t width = 1, height = 1;
    std::vector<glm::vec3> texels{glm::vec3(0.0f)};  ///< W/(sr m^2), rows from the zenith down
    float rotation = 0;                              ///< about z, radians, counterclockwise from above
    std::filesystem::path image;                     ///< the file it was read from, if it was
    glm::dvec3 scale{1.0};                           ///< by which the picture's values were multiplied
    std::optional<SkySettings> sky;                  ///< what the texels were computed from, if they were

    /// Returns the radiance from a unit direction, W/(sr m^2).
    glm::vec3 radiance(const glm::vec3& direction) const { return texels[texel(direction)]; }
    /// Returns the index of the texel in a unit direction.
    size_t texel(const glm::vec3& direction) const;

    bool operator==(const Environment&) const = default;
};

/// Largest number of texels: 8192 x 4096 take 384 MiB.
inline constexpr uint64_t kMostEnvironmentTexels = uint64_t{1} << 25;

/// Reads an .exr or .hdr picture (told apart by the extension) and multiplies it by `scale`. Negative
/// values, which filters leave in pictures, become 0. Errors: those of the reader, a picture that is too
/// large, a texel that is not finite.
Result<Environment> load_environment(const std::filesystem::path& path, const glm::dvec3& scale,
                                     double rotation);

}  // namespace lucarne::gi
