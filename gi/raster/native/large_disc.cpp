#include "gi/raster/native/large_disc.h"

namespace lucarne::gi::native {

std::optional<LargeBox> large_box(const ViewDisc& disc, const DiscView& view) {
    const glm::vec2 size(view.width, view.height);
    const DiscBox box = disc_box(disc, {.size = size,
                                        .scale = size / (2.0f * glm::vec2(view.right.w, view.down.w)),
                                        .middle = 0.5f * size - view.shift,
                                        .near = view.forward.w,
                                        .parallel = view.origin.w > 0});
    if (is_empty(box)) return std::nullopt;
    const glm::ivec2 first(box.first), last(box.last);
    return LargeBox{{first.x, first.y, last.x + 1, last.y + 1}, glm::ivec2(box.home)};
}

}  // namespace lucarne::gi::native
