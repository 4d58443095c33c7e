#pragma once

#include <span>

#include "io/image/image.h"
#include "viewer/overlay/overlay.h"

namespace lucarne::viewer {

/// Draws marks into a picture without a window; texts in the interface's font, `scale` times its size.
void draw_marks(std::span<const Mark> marks, int scale, io::Image8& picture);

}  // namespace lucarne::viewer
