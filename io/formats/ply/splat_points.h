#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "io/points.h"

namespace lucarne::io::ply {

/// A Gaussian: standard deviations `scale` along its own axes, turned by `rotation`.
struct Splat {
    glm::vec3 color{0.5f};  ///< sRGB, 0 to 1
    float opacity = 1;
    glm::vec3 scale{0.0f};
    glm::quat rotation{1, 0, 0, 0};
};

inline constexpr std::string_view kNearlyTransparent = "splats that are nearly transparent";

/// Adds the attributes of splats (splats.h) to a schema that has only a position.
void add_splat_attributes(Schema& schema);
/// Writes these attributes of a splat to a record whose position is written already. Returns false if the
/// splat is nearly transparent or no number; the record is then invalid.
bool write_splat(const Splat& splat, std::byte* attributes);

}  // namespace lucarne::io::ply
