#include "gi/lighting/lobe_albedo.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

namespace lucarne::gi {

LobeAlbedo::LobeAlbedo(float exponent) {
    // Directions about the mirror direction by the density (n + 1) / (2 pi) cos^n.
    constexpr int kRings = 32, kSectors = 32;
    for (uint32_t step = 0; step <= kSteps; ++step) {
        const double cosine = static_cast<double>(step) / kSteps, sine = std::sqrt(1 - cosine * cosine);
        double sum = 0;
        for (int ring = 0; ring < kRings; ++ring) {
            const double height = std::pow((ring + .5) / kRings, 1.0 / (exponent + 1.0));
            const double radius = std::sqrt(1 - height * height);
            for (int sector = 0; sector < kSectors; ++sector)
                sum += std::max(
                    0.0,
                    height * cosine +
                        radius * std::cos(2 * static_cast<double>(kPi) * (sector + .5) / kSectors) * sine);
        }
        values_[step] = static_cast<float>((exponent + 2.0) / (exponent + 1.0) * sum / (kRings * kSectors));
    }
    // 2 times the integral of the cosine times the value, which is linear from step to step.
    for (uint32_t step = 0; step < kSteps; ++step) {
        const float from = static_cast<float>(step) / kSteps, to = static_cast<float>(step + 1) / kSteps;
        mean_ += (values_[step] * (2 * from + to) + values_[step + 1] * (from + 2 * to)) / (3 * kSteps);
    }
}

float LobeAlbedo::at(float cosine) const {
    const float place = std::clamp(cosine, 0.0f, 1.0f) * kSteps;
    const auto step = std::min(static_cast<uint32_t>(place), kSteps - 1);
    return glm::mix(values_[step], values_[step + 1], place - static_cast<float>(step));
}

void LobeAlbedos::take(std::span<const Material> materials) {
    for (const Material& material : materials) {
        const Reflectance r = make_reflectance(material, glm::vec3(0.0f));
        if (r.ks > 0) by_exponent_.try_emplace(r.exponent, r.exponent);
    }
}

const LobeAlbedo* LobeAlbedos::find(float exponent) const {
    const auto found = by_exponent_.find(exponent);
    return found == by_exponent_.end() ? nullptr : &found->second;
}

}  // namespace lucarne::gi
