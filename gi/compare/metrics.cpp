#include "gi/compare/metrics.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace lucarne::gi {
namespace {

double luminance(const glm::vec4& c) {
    return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

Result<void> check_finite(std::span<const glm::vec4> picture, const char* name) {
    for (size_t i = 0; i < picture.size(); ++i)
        if (!std::isfinite(picture[i].x + picture[i].y + picture[i].z))
            return rejected(name, fmt::format("pixel {} is not a finite radiance", i));
    return {};
}

}  // namespace

double mean_luminance(std::span<const glm::vec4> picture) {
    double sum = 0;
    for (const glm::vec4& pixel : picture) sum += luminance(pixel);
    return picture.empty() ? 0 : sum / static_cast<double>(picture.size());
}

Result<ImageMetrics> compare_images(std::span<const glm::vec4> picture,
                                    std::span<const glm::vec4> reference) {
    if (picture.size() != reference.size() || picture.empty())
        return rejected("pictures",
                        fmt::format("{} pixels cannot be compared with {}", picture.size(), reference.size()),
                        "render both at the same --size");
    LUCARNE_TRY(check_finite(picture, "first picture"));
    LUCARNE_TRY(check_finite(reference, "second picture"));
    const auto values = 3.0 * static_cast<double>(reference.size());
    double sum = 0;
    for (const glm::vec4& r : reference) sum += double{r.x} + r.y + r.z;
    // Of two black pictures every term is 0 / 0: the least double keeps it 0.
    const double epsilon = 0.01 * (sum / values) * (sum / values) + std::numeric_limits<double>::min();
    double squares = 0, relative = 0;
    for (size_t i = 0; i < reference.size(); ++i)
        for (int channel = 0; channel < 3; ++channel) {
            const double r = reference[i][channel], difference = picture[i][channel] - r;
            squares += difference * difference;
            relative += difference * difference / (r * r + epsilon);
        }
    ImageMetrics metrics;
    metrics.mean_luminance = mean_luminance(picture);
    metrics.reference_mean_luminance = mean_luminance(reference);
    const double difference = metrics.mean_luminance - metrics.reference_mean_luminance;
    metrics.luminance_error = difference == 0 ? 0 : difference / metrics.reference_mean_luminance;
    metrics.rel_mse = relative / values;
    metrics.rmse = std::sqrt(squares / values);
    return metrics;
}

}  // namespace lucarne::gi
