#pragma once

#include <optional>

#include <glm/vec2.hpp>

#include "gi/raster/disc_view.h"
#include "gi/raster/native/tiles.h"
#include "gi/shared/disc.h"

namespace lucarne::gi::native {

/// The pixels whose centres a large disc may cover, and the pixel of its centre.
struct LargeBox {
    PixelRect rect;
    glm::ivec2 home;  ///< (-1, -1) if the centre is behind the eye or outside the picture
};

/// disc_box() of gi/shared/disc.h; none if there are no such pixels.
std::optional<LargeBox> large_box(const ViewDisc& disc, const DiscView& view);

}  // namespace lucarne::gi::native
