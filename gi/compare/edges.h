#pragma once

#include <cstdint>
#include <vector>

#include "gi/raster/gbuffer.h"
#include "io/image/image.h"

namespace lucarne::gi {

// Light is blurred or leaks beside edges, in a small share of the pixels that a mean hides. A mask is 1 for
// the pixels at an edge and those next to them (3 x 3), 0 for all others.

/// Returns the picture that `lucarne render --gbuffer` writes: R, G, B the unit normal turned toward the
/// viewer (components -1 to 1), A the depth along the camera's forward axis, m; all 0 where nothing is
/// visible.
io::Image gbuffer_image(const GBuffer& gbuffer);

/// Returns the edges of depth and normal in such a picture. 1/z is linear in the pixels of a plane
/// (perspective), so its second difference tells a step or a crease from a slope, however steep. Depths that
/// are not finite count as empty.
std::vector<uint8_t> gbuffer_edges(const io::Image& gbuffer);

/// Returns the edges of the reference's own luminance, for use without a G-buffer: shadows and textures
/// count as well.
std::vector<uint8_t> luminance_edges(const io::Image& reference);

}  // namespace lucarne::gi
