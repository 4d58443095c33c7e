#include "gi/compare/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "io/core/quantile.h"

namespace lucarne::gi {
namespace {

using Pixels = std::span<const glm::vec4>;
using Selection = std::span<const uint8_t>;

Result<void> check_pair(Pixels picture, Pixels reference, Selection mask) {
    if (picture.size() != reference.size() || picture.empty())
        return rejected("pictures",
                        fmt::format("{} pixels cannot be compared with {}", picture.size(), reference.size()),
                        "render both at the same --size");
    if (!mask.empty() && mask.size() != picture.size())
        return rejected("mask", fmt::format("{} pixels for a picture of {}", mask.size(), picture.size()));
    if (!mask.empty() && std::all_of(mask.begin(), mask.end(), [](uint8_t in) { return in == 0; }))
        return rejected("mask", "no pixel is to be compared");
    const auto row = static_cast<uint32_t>(std::min<size_t>(picture.size(), UINT32_MAX));
    LUCARNE_TRY(check_radiance(picture, row, "first picture"));
    return check_radiance(reference, row, "second picture");
}

/// Calls use(i) for every pixel of the mask, in order.
template <class Use>
void for_each(size_t pixels, Selection mask, const Use& use) {
    for (size_t i = 0; i < pixels; ++i)
        if (mask.empty() || mask[i]) use(i);
}

double mean_of_channels(const glm::dvec3& v) {
    return (v.x + v.y + v.z) / 3;
}

size_t trimmed_count(size_t count) {
    return static_cast<size_t>(kTrimmed * static_cast<double>(count));
}

/// Returns the mean without the worst share kTrimmed; reorders the values.
double trimmed_mean(std::vector<double>& errors) {
    const size_t kept = errors.size() - trimmed_count(errors.size());
    const auto worst = errors.begin() + static_cast<ptrdiff_t>(kept);
    if (worst != errors.end()) std::nth_element(errors.begin(), worst, errors.end());
    return std::accumulate(errors.begin(), worst, 0.0) / static_cast<double>(kept);
}

}  // namespace

Result<void> check_radiance(Pixels pixels, uint32_t width, const std::string& name) {
    size_t bad = 0, first = 0;
    for (size_t i = 0; i < pixels.size(); ++i)
        if (!std::isfinite(pixels[i].x) || !std::isfinite(pixels[i].y) || !std::isfinite(pixels[i].z))
            if (bad++ == 0) first = i;
    if (bad == 0) return {};
    return rejected(name,
                    fmt::format("{} of {} pixels are no finite radiance, the first at column {}, row {}", bad,
                                pixels.size(), first % width, first / width));
}

double mean_luminance(Pixels picture) {
    double sum = 0;
    for (const glm::vec4& pixel : picture) sum += luminance(pixel);
    return picture.empty() ? 0 : sum / static_cast<double>(picture.size());
}

double relative_epsilon(Pixels reference) {
    double sum = 0;
    for (const glm::vec4& r : reference) sum += mean_of_channels(glm::dvec3(r));
    const double mean = reference.empty() ? 0 : sum / static_cast<double>(reference.size());
    // For two black pictures every term would be 0 / 0; the least double makes it 0.
    return 0.01 * mean * mean + std::numeric_limits<double>::min();
}

Result<ImageMetrics> compare_images(Pixels picture, Pixels reference, Selection mask) {
    LUCARNE_TRY(check_pair(picture, reference, mask));
    const double epsilon = relative_epsilon(reference);
    ImageMetrics metrics;
    std::vector<double> errors;
    errors.reserve(picture.size());
    double squares = 0, relative = 0;
    for_each(picture.size(), mask, [&](size_t i) {
        const glm::dvec3 a(picture[i]), r(reference[i]), square = (a - r) * (a - r);
        metrics.mean_luminance += luminance(picture[i]);
        metrics.reference_mean_luminance += luminance(reference[i]);
        squares += mean_of_channels(square);
        errors.push_back(mean_of_channels(square / (r * r + epsilon)));
        relative += errors.back();
    });
    metrics.pixels = errors.size();
    const auto count = static_cast<double>(errors.size());
    metrics.mean_luminance /= count;
    metrics.reference_mean_luminance /= count;
    const double difference = metrics.mean_luminance - metrics.reference_mean_luminance;
    metrics.luminance_error = difference == 0 ? 0 : difference / metrics.reference_mean_luminance;
    metrics.rel_mse = relative / count;
    metrics.rmse = std::sqrt(squares / count);
    metrics.p99 = std::sqrt(nearest_rank(errors, 0.99));
    metrics.trimmed_pixels = trimmed_count(errors.size());
    metrics.rel_mse_trimmed = trimmed_mean(errors);
    return metrics;
}

Result<HalvesError> compare_with_halves(Pixels picture, Pixels first, Pixels second, Selection mask) {
    LUCARNE_TRY(check_pair(picture, first, mask));
    LUCARNE_TRY(check_pair(picture, second, mask));
    std::vector<glm::vec4> mean(first.size());
    for (size_t i = 0; i < mean.size(); ++i) mean[i] = 0.5f * (first[i] + second[i]);
    const double epsilon = relative_epsilon(mean);
    double sum = 0, squares = 0, noise = 0, count = 0;
    std::vector<double> products;
    for_each(picture.size(), mask, [&](size_t i) {
        const glm::dvec3 a(picture[i]), r1(first[i]), r2(second[i]), r(mean[i]);
        const glm::dvec3 scale = 1.0 / (r * r + epsilon), half = 0.5 * (r1 - r2);
        const double product = mean_of_channels((a - r1) * (a - r2) * scale);
        products.push_back(product);
        sum += product;
        squares += product * product;
        noise += mean_of_channels(half * half * scale);
        ++count;
    });
    HalvesError error;
    error.rel_mse = sum / count;
    error.standard_error = std::sqrt(std::max(0.0, squares / count - error.rel_mse * error.rel_mse) / count);
    error.reference_rel_mse = noise / count;
    error.rel_mse_trimmed = trimmed_mean(products);
    return error;
}

}  // namespace lucarne::gi
