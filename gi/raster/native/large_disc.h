#pragma once

#include <optional>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "gi/raster/disc_view.h"
#include "gi/raster/native/tiles.h"

namespace lucarne::gi::native {

/// A disc over 8 pixels in radius, see `Disc` in disc.glsl.
struct LargeDisc {
    glm::vec3 centre, normal;
    float radius, extent, push;
};

/// The pixels whose centres a large disc may cover, and the pixel of its centre.
struct LargeBox {
    PixelRect rect;
    glm::ivec2 home;  ///< (-1, -1) if the centre is behind the eye or outside the picture
};

/// The same as disc_box() in disc.glsl; none if there are no such pixels.
std::optional<LargeBox> large_box(const LargeDisc& disc, const DiscView& view);

}  // namespace lucarne::gi::native
