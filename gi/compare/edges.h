#pragma once

#include <cstdint>
#include <vector>

#include "gi/raster/gbuffer.h"
#include "io/image/image.h"

namespace lucarne::gi {

// Where light is blurred or leaks is beside edges, a small share of the pixels that a mean hides. A mask
// holds 1 for the pixels at an edge and those next to them (3 x 3), 0 for all others.

/// What `lucarne render --gbuffer` writes: R, G, B the unit normal turned toward the viewer (components -1 to
/// 1), A the depth along the camera's forward axis, m; all 0 where nothing is seen.
io::Image gbuffer_image(const GBuffer& gbuffer);

/// Edges of depth and normal in such a picture. Depth: 1/z is linear in the pixels of a plane (perspective),
/// so its second difference tells a step or a crease from a slope, however steep. What is not finite counts
/// as nothing seen.
std::vector<uint8_t> gbuffer_edges(const io::Image& gbuffer);

/// Edges of the reference's own luminance, where no G-buffer is at hand: shadows and textures count as well.
std::vector<uint8_t> luminance_edges(const io::Image& reference);

}  // namespace lucarne::gi
