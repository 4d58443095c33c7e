// Compares pictures of the whole window with the golden ones: tests/viewer/window/golden/README.md.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "io/image/image.h"

namespace lucarne::test {

/// The difference of two pictures of one size, of 255, by the means of squares of 8x8 pixels. So the exact
/// pixels of a glyph or an edge do not matter, but their amount does.
struct GoldenDifference {
    static constexpr uint32_t kSquare = 8;  ///< pixels
    static constexpr double kMostMean = 0.5,
                            kMostWorst = 12;  ///< tolerances: README.md says what they let through

    double mean = 0;        ///< of all squares
    double worst = 0;       ///< of one square and channel
    uint32_t x = 0, y = 0;  ///< pixel where the worst square begins

    bool tolerated() const { return mean <= kMostMean && worst <= kMostWorst; }
};

inline std::array<double, 3> square_mean(const io::Image8& image, uint32_t x, uint32_t y) {
    std::array<double, 3> sum{};
    const uint32_t right = std::min(x + GoldenDifference::kSquare, image.width);
    const uint32_t bottom = std::min(y + GoldenDifference::kSquare, image.height);
    for (uint32_t row = y; row < bottom; ++row)
        for (uint32_t column = x; column < right; ++column)
            for (size_t c = 0; c < 3; ++c)
                sum[c] += image.bytes[3 * (size_t{row} * image.width + column) + c];
    for (double& channel : sum) channel /= (right - x) * (bottom - y);
    return sum;
}

/// Returns the difference. Pictures of different sizes differ completely.
inline GoldenDifference golden_difference(const io::Image8& a, const io::Image8& b) {
    GoldenDifference found;
    if (a.width != b.width || a.height != b.height) return {255, 255, 0, 0};
    size_t squares = 0;
    for (uint32_t y = 0; y < a.height; y += GoldenDifference::kSquare)
        for (uint32_t x = 0; x < a.width; x += GoldenDifference::kSquare, ++squares) {
            const auto of_a = square_mean(a, x, y), of_b = square_mean(b, x, y);
            double worst = 0;
            for (size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(of_a[c] - of_b[c]));
            found.mean += worst;
            if (worst > found.worst) found = {found.mean, worst, x, y};
        }
    found.mean /= static_cast<double>(squares);
    return found;
}

}  // namespace lucarne::test
