#pragma once

#include <span>

#include "io/image/image.h"

namespace lucarne::gi {

/// Draws errors of 0 to 1, row by row, from black over violet and orange to a pale yellow (matplotlib's
/// magma).
io::Image8 magma_picture(std::span<const float> errors, uint32_t width);

/// Draws where a picture is too dark (blue) or too bright (red) in luminance. White is equal; the full
/// colour is an error as large as sqrt(r^2 + .01 m^2), r the reference's value and m its mean. Both pictures
/// have the same size.
io::Image8 signed_picture(const io::Image& picture, const io::Image& reference);

}  // namespace lucarne::gi
