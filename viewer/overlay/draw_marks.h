#pragma once

#include <span>

#include "io/image/image.h"
#include "viewer/overlay/overlay.h"

namespace lucarne::viewer {

/// Draws marks into a picture without a window. Texts use the interface's font at `scale` times its size.
void draw_marks(std::span<const Mark> marks, int scale, io::Image8& picture);

}  // namespace lucarne::viewer
