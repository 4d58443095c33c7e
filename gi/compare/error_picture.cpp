#include "gi/compare/error_picture.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "gi/compare/metrics.h"
#include "gi/scene/colour_map.h"

namespace lucarne::gi {
namespace {

/// Appends a pixel; `colour` is sRGB-coded, 0 to 1.
void push(io::Image8& image, const glm::vec3& colour) {
    for (int c = 0; c < 3; ++c)
        image.bytes.push_back(static_cast<uint8_t>(std::lround(255 * std::clamp(colour[c], 0.0f, 1.0f))));
}

}  // namespace

io::Image8 magma_picture(std::span<const float> errors, uint32_t width) {
    io::Image8 image{width, static_cast<uint32_t>(errors.size() / width), {}};
    image.bytes.reserve(3 * errors.size());
    for (const float error : errors) push(image, mapped_colour(ColourMap::magma, error));
    return image;
}

io::Image8 signed_picture(const io::Image& picture, const io::Image& reference) {
    constexpr glm::vec3 kDark(0.1f, 0.25f, 0.8f), kEqual(1), kBright(0.8f, 0.1f, 0.1f);
    const double epsilon = relative_epsilon(reference.pixels);
    io::Image8 image{picture.width, picture.height, {}};
    image.bytes.reserve(3 * picture.pixels.size());
    for (size_t i = 0; i < picture.pixels.size(); ++i) {
        const double r = luminance(reference.pixels[i]);
        const auto error =
            static_cast<float>((luminance(picture.pixels[i]) - r) / std::sqrt(r * r + epsilon));
        push(image, glm::mix(kEqual, error < 0 ? kDark : kBright, std::min(std::abs(error), 1.0f)));
    }
    return image;
}

}  // namespace lucarne::gi
