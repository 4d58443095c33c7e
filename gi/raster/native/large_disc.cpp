#include "gi/raster/native/large_disc.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

namespace lucarne::gi::native {
namespace {

/// tangent_range() of disc.glsl.
glm::vec2 tangent_range(float centre, float normal, const LargeDisc& disc, bool orthographic) {
    const float r2 = disc.radius * disc.radius;
    if (orthographic)
        return centre + disc.radius * std::sqrt(std::max(1 - normal * normal, 0.0f)) * glm::vec2(-1, 1);
    const float a = disc.centre.z * disc.centre.z - disc.extent * disc.extent;
    const float b = centre * disc.centre.z + r2 * normal * disc.normal.z;
    const float c = centre * centre - r2 * (1 - normal * normal);
    const float root = std::sqrt(std::max(b * b - a * c, 0.0f));
    return glm::vec2(b - root, b + root) / a;
}

}  // namespace

std::optional<LargeBox> large_box(const LargeDisc& disc, const DiscView& view) {
    const bool flat = view.origin.w > 0;
    const glm::vec2 size(view.width, view.height);
    const glm::vec2 scale = size / (2.0f * glm::vec2(view.right.w, view.down.w));
    const glm::vec2 middle = 0.5f * size - view.shift;
    const auto inside = [](float at, float end) { return at > -1 ? std::min(at, end) : -1.0f; };  // NaN: -1
    const auto in_picture = [&](const glm::vec2& at) {
        return glm::vec2(inside(at.x, size.x), inside(at.y, size.y));
    };
    LargeBox box{{0, 0, static_cast<int>(view.width), static_cast<int>(view.height)}, glm::ivec2(-1)};
    if (disc.centre.z > view.forward.w) {
        const glm::vec2 place = glm::vec2(disc.centre) / (flat ? 1.0f : disc.centre.z) * scale + middle;
        box.home = glm::ivec2(glm::floor(in_picture(place)));
    }
    if (flat || disc.centre.z > 1.001f * disc.extent) {  // else the disc reaches behind the eye
        const glm::vec2 x = tangent_range(disc.centre.x, disc.normal.x, disc, flat),
                        y = tangent_range(disc.centre.y, disc.normal.y, disc, flat);
        const glm::vec2 low = glm::vec2(x.x, y.x) * scale + middle,
                        high = glm::vec2(x.y, y.y) * scale + middle;
        const glm::ivec2 first =
            glm::max(glm::min(glm::ivec2(glm::ceil(in_picture(low - 0.5f))), box.home), glm::ivec2(0));
        const glm::ivec2 last = glm::min(glm::max(glm::ivec2(glm::floor(in_picture(high - 0.5f))), box.home),
                                         glm::ivec2(size) - 1);
        box.rect = {first.x, first.y, last.x + 1, last.y + 1};
    }
    if (box.rect.x0 >= box.rect.x1 || box.rect.y0 >= box.rect.y1) return std::nullopt;
    return box;
}

}  // namespace lucarne::gi::native
