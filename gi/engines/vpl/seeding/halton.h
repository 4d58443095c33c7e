#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "io/core/random.h"

namespace lucarne::gi::vpl {

/// Returns Van der Corput's radical inverse: the digits of `index` in base `base`, mirrored at the point; in
/// [0, 1).
inline double radical_inverse(uint32_t base, uint64_t index) {
    double digit_weight = 1.0, value = 0.0;
    for (; index > 0; index /= base) {
        digit_weight /= base;
        value += digit_weight * static_cast<double>(index % base);
    }
    return value;
}

/// Returns the position of a point of [0, 1)^2 along a Z-order curve: neighbours on the curve are neighbours
/// in the square.
inline uint32_t curve_position(const glm::vec2& point) {
    uint32_t position = 0;
    const auto x = static_cast<uint32_t>(point.x * 65536), y = static_cast<uint32_t>(point.y * 65536);
    for (uint32_t bit = 0; bit < 16; ++bit)
        position |= (x >> bit & 1) << 2 * bit | (y >> bit & 1) << (2 * bit + 1);
    return position;
}

/// Returns `count` points of the Halton sequence in bases 2 and 3 (Halton 1960), shifted on the torus by a
/// random vector that depends on `seed` and `frame` (Cranley and Patterson 1976). Every frame has other
/// samples, every run the same. The points are sorted along a curve, so that runs of them are clusters and
/// every n-th point is an even sample.
inline std::vector<glm::vec2> halton_points(uint32_t count, uint64_t seed, uint64_t frame) {
    Random random(seed, frame);
    const double shift_x = random.uniform(), shift_y = random.uniform();
    const auto on_torus = [](double v) {
        // Rounding to float may give 1, which is outside.
        return std::min(static_cast<float>(v - std::floor(v)), std::nextafter(1.0f, 0.0f));
    };
    std::vector<glm::vec2> points(count);
    for (uint32_t i = 0; i < count; ++i)
        points[i] = {on_torus(radical_inverse(2, i) + shift_x), on_torus(radical_inverse(3, i) + shift_y)};
    std::stable_sort(points.begin(), points.end(), [](const glm::vec2& a, const glm::vec2& b) {
        return curve_position(a) < curve_position(b);
    });
    return points;
}

}  // namespace lucarne::gi::vpl
