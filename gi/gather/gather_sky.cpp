#include "gi/gather/gather_sky.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gi/shared/environment.h"
#include "gi/shared/luminance.h"

namespace lucarne::gi {
namespace {

/// The largest picture: its texels are a quarter as large as the finest micro-buffer's.
constexpr uint32_t kMostSkyColumns = 256, kMostSkyRows = 128;
/// A texel this many times as bright as the mean is too bright for one ray among 64.
constexpr double kBrightest = 16;
/// Bright texels that add less than this share to the sky need no views of their own.
constexpr double kLeastBright = 0.002;

/// Returns the solid angle of the texels of a row that lie between two heights in the picture (0 to 1), per
/// width of the whole picture.
double solid_angle(double top, double low) {
    return 2 * M_PI * (std::cos(M_PI * top) - std::cos(M_PI * low));
}

/// A row or column of a smaller picture: which of the larger one it covers, and their shares.
struct Overlap {
    uint32_t first;
    std::vector<double> shares;
};

/// Returns for each of `count` parts which of `from` parts it covers, weighted by `size(low, high)` of their
/// common stretch of [0, 1].
template <class Size>
std::vector<Overlap> overlaps(uint32_t from, uint32_t count, const Size& size) {
    std::vector<Overlap> result;
    for (uint64_t i = 0; i < count; ++i) {
        Overlap overlap{static_cast<uint32_t>(i * from / count), {}};
        const double low = static_cast<double>(i) / count, high = static_cast<double>(i + 1) / count;
        for (uint64_t k = overlap.first; k * count < (i + 1) * from; ++k) {
            const double begin = std::max(low, static_cast<double>(k) / from);
            const double end = std::min(high, static_cast<double>(k + 1) / from);
            overlap.shares.push_back(std::max(size(begin, end), 0.0) / size(low, high));
        }
        result.push_back(std::move(overlap));
    }
    return result;
}

/// Returns the part of a texel up to a luminance.
glm::vec3 up_to(const glm::vec3& texel, double most) {
    const double found = luminance(glm::dvec3(texel));
    return found > most ? texel * static_cast<float>(most / found) : texel;
}

/// Returns the mean of what is not brighter than `most` over each texel of a smaller picture, by solid angle.
std::vector<glm::vec3> reduced(const Environment& sky, uint32_t width, uint32_t height, double most) {
    const auto columns = overlaps(sky.width, width, [](double low, double high) { return high - low; });
    const auto rows = overlaps(sky.height, height, solid_angle);
    std::vector<glm::vec3> texels;
    for (const Overlap& row : rows)
        for (const Overlap& column : columns) {
            glm::dvec3 sum(0.0);
            for (size_t j = 0; j < row.shares.size(); ++j)
                for (size_t i = 0; i < column.shares.size(); ++i) {
                    const size_t at = (row.first + j) * sky.width + column.first + i;
                    sum += row.shares[j] * column.shares[i] * glm::dvec3(up_to(sky.texels[at], most));
                }
            texels.push_back(glm::vec3(sum));
        }
    return texels;
}

/// Returns the luminance times the solid angle of what is brighter than `most`.
double light_beyond(const Environment& sky, double most) {
    double sum = 0;
    for (uint32_t y = 0; y < sky.height; ++y) {
        double row = 0;
        for (uint32_t x = 0; x < sky.width; ++x)
            row += std::max(luminance(glm::dvec3(sky.texels[size_t{y} * sky.width + x])) - most, 0.0);
        sum += row / sky.width *
               solid_angle(static_cast<double>(y) / sky.height, static_cast<double>(y + 1) / sky.height);
    }
    return sum;
}

}  // namespace

glm::vec3 GatherSky::radiance(const glm::vec3& direction) const {
    const glm::vec2 at = environment_place(direction, rotation);
    const auto column = static_cast<uint32_t>(at.x * static_cast<float>(width));
    const auto row = static_cast<uint32_t>(at.y * static_cast<float>(height));
    return texels[size_t{std::min(row, height - 1)} * width + std::min(column, width - 1)];
}

GatherSky gather_sky(const std::shared_ptr<const Environment>& environment) {
    if (!environment) return {};
    const Environment& whole = *environment;
    const double total = light_beyond(whole, 0);
    if (!(total > 0)) return {};
    double most = kBrightest * total / (4 * M_PI);
    if (light_beyond(whole, most) <= kLeastBright * total) most = std::numeric_limits<double>::infinity();
    GatherSky sky{.width = std::min(whole.width, kMostSkyColumns),
                  .height = std::min(whole.height, kMostSkyRows),
                  .rotation = whole.rotation};
    sky.texels = reduced(whole, sky.width, sky.height, most);
    if (std::isinf(most)) return sky;
    const auto bright = std::make_shared<Environment>(whole);
    for (glm::vec3& texel : bright->texels) texel -= up_to(texel, most);
    sky.bright = bright;
    return sky;
}

}  // namespace lucarne::gi
