#include "viewer/light/darkness.h"

#include <algorithm>

namespace lucarne::viewer {
namespace {

constexpr std::byte kLit{26};  ///< of 255, coded: a hundredth of white
constexpr size_t kPointsPerLit = 50;

}  // namespace

bool is_dark(const Picture& picture) {
    size_t points = 0, lit = 0;
    for (size_t i = 0; i < picture.depth.size() && 4 * i + 2 < picture.rgba.size(); ++i) {
        if (!(picture.depth[i] > 0)) continue;
        ++points;
        const std::byte* pixel = &picture.rgba[4 * i];
        lit += std::max({pixel[0], pixel[1], pixel[2]}) > kLit;
    }
    return points > 0 && lit * kPointsPerLit < points;
}

}  // namespace lucarne::viewer
