#pragma once

#include <span>

#include "io/image/image.h"

namespace lucarne::gi {

/// Errors of 0 to 1, row by row, from black over violet and orange to a pale yellow (matplotlib's magma).
io::Image8 magma_picture(std::span<const float> errors, uint32_t width);

/// Where a picture is too dark (blue) or too bright (red) against the reference, in luminance: white is
/// equal, the full colour an error as large as sqrt(r^2 + .01 m^2), r the reference's value and m its mean.
/// Both of one size.
io::Image8 signed_picture(const io::Image& picture, const io::Image& reference);

}  // namespace lucarne::gi
