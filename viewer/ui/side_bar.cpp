#include "viewer/ui/side_bar.h"

#include <algorithm>

namespace lucarne::viewer {

double SideBar::pixels(double text_height, double window_width) const {
    if (!shown) return 0;
    return std::min(std::clamp(width, kLeast, kMost) * text_height, 0.6 * window_width);
}

}  // namespace lucarne::viewer
