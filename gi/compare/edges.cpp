#include "gi/compare/edges.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "gi/compare/metrics.h"
#include "gi/shared/surfel_code.h"

namespace lucarne::gi {
namespace {

using Mask = std::vector<uint8_t>;

// A step of 2 % of the depth: ten times the noise of a scanned wall, a tenth of the step at a doorway.
constexpr double kDepthStep = 0.02;
constexpr double kSameNormal = 0.9;  // cosine: 26 degrees
// Two neighbours form an edge if their luminances differ by the first share of the larger one and by the
// second share of the picture's mean, so that neither noise nor darkness counts.
constexpr double kContrast = 0.25, kLeastContrast = 0.05;

/// Calls line(first, step, count) for every row and column; a line consists of the pixels first + k * step.
template <class Line>
void for_each_line(const io::Image& image, const Line& line) {
    const size_t width = image.width, height = image.height;
    for (size_t y = 0; y < height; ++y) line(y * width, size_t{1}, width);
    for (size_t x = 0; x < width; ++x) line(x, width, height);
}

/// Marks both pixels of every pair of neighbours that differ.
template <class Differ>
void mark_pairs(const io::Image& image, const Differ& differ, Mask& mask) {
    for_each_line(image, [&](size_t first, size_t step, size_t count) {
        for (size_t k = 0; k + 1 < count; ++k) {
            const size_t a = first + k * step, b = a + step;
            if (differ(image.pixels[a], image.pixels[b])) mask[a] = mask[b] = 1;
        }
    });
}

/// Marks every pixel next to a marked one, diagonals included.
Mask widen(const io::Image& image, Mask mask) {
    const auto along = [&](bool rows) {
        Mask wide = mask;
        for_each_line(image, [&](size_t first, size_t step, size_t count) {
            if ((step == 1) != rows) return;
            for (size_t k = 0; k < count; ++k) {
                const size_t at = first + k * step;
                if ((k > 0 && mask[at - step]) || (k + 1 < count && mask[at + step])) wide[at] = 1;
            }
        });
        mask = std::move(wide);
    };
    along(true);
    if (image.height > 1) along(false);
    return mask;
}

bool seen(const glm::vec4& texel) {
    return texel.w > 0 && std::isfinite(texel.w);
}

/// Returns whether depth has a step or a crease at b, between its neighbours a and c.
bool bent(const glm::vec4& a, const glm::vec4& b, const glm::vec4& c) {
    if (!seen(a) || !seen(b) || !seen(c)) return false;  // mark_pairs finds the border of visible surfaces
    return std::abs(1 / double{a.w} - 2 / double{b.w} + 1 / double{c.w}) * double{b.w} > kDepthStep;
}

}  // namespace

io::Image gbuffer_image(const GBuffer& gbuffer) {
    io::Image image{gbuffer.width, gbuffer.height, {}};
    image.pixels.reserve(size_t{gbuffer.width} * gbuffer.height);
    for (const auto& texel :
         gbuffer.texels.download_all<GBufferTexel>(size_t{gbuffer.width} * gbuffer.height))
        image.pixels.push_back(texel.depth > 0 ? glm::vec4(decode_octahedral(texel.normal), texel.depth)
                                               : glm::vec4(0));
    return image;
}

std::vector<uint8_t> gbuffer_edges(const io::Image& gbuffer) {
    Mask mask(gbuffer.pixels.size(), 0);
    const auto differ = [](const glm::vec4& a, const glm::vec4& b) {
        if (seen(a) != seen(b)) return true;
        return seen(a) && !(glm::dot(glm::vec3(a), glm::vec3(b)) >= kSameNormal);
    };
    mark_pairs(gbuffer, differ, mask);
    for_each_line(gbuffer, [&](size_t first, size_t step, size_t count) {
        for (size_t k = 1; k + 1 < count; ++k) {
            const size_t at = first + k * step;
            if (bent(gbuffer.pixels[at - step], gbuffer.pixels[at], gbuffer.pixels[at + step])) mask[at] = 1;
        }
    });
    return widen(gbuffer, std::move(mask));
}

std::vector<uint8_t> luminance_edges(const io::Image& reference) {
    Mask mask(reference.pixels.size(), 0);
    const double least = kLeastContrast * mean_luminance(reference.pixels);
    const auto differ = [&](const glm::vec4& a, const glm::vec4& b) {
        const double la = luminance(a), lb = luminance(b), apart = std::abs(la - lb);
        return apart > kContrast * std::max(la, lb) && apart > least;
    };
    mark_pairs(reference, differ, mask);
    return widen(reference, std::move(mask));
}

}  // namespace lucarne::gi
