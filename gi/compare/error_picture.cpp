#include "gi/compare/error_picture.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "gi/compare/metrics.h"

namespace lucarne::gi {
namespace {

/// Polynomials of degree 6 fitted to magma (van der Walt and Smith 2015, CC0) by Zucker 2019 (CC0), to 1 % or
/// better.
glm::vec3 magma(float t) {
    constexpr glm::vec3 kTerms[] = {
        {-0.00213649f, -0.00074966f, -0.00538613f},  {0.25166054f, 0.67752324f, 2.49402660f},
        {8.35371728f, -3.57771951f, 0.31446790f},    {-27.66873309f, 14.26473078f, -13.64921319f},
        {52.17613981f, -27.94360607f, 12.94416944f}, {-50.76852537f, 29.04658282f, 4.23415299f},
        {18.65570507f, -11.48977352f, -5.60196151f}};
    glm::vec3 colour(0);
    for (size_t i = std::size(kTerms); i-- > 0;) colour = colour * t + kTerms[i];
    return colour;
}

/// sRGB-coded, 0 to 1.
void push(io::Image8& image, const glm::vec3& colour) {
    for (int c = 0; c < 3; ++c)
        image.bytes.push_back(static_cast<uint8_t>(std::lround(255 * std::clamp(colour[c], 0.0f, 1.0f))));
}

}  // namespace

io::Image8 magma_picture(std::span<const float> errors, uint32_t width) {
    io::Image8 image{width, static_cast<uint32_t>(errors.size() / width), {}};
    image.bytes.reserve(3 * errors.size());
    for (const float error : errors) push(image, magma(std::clamp(error, 0.0f, 1.0f)));
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
