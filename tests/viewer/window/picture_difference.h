#pragma once

#include <cmath>
#include <cstdint>

#include "io/image/image.h"

namespace lucarne::test {

inline double difference(const io::Image8& a, const io::Image8& b) {  ///< mean difference, of 255
    double sum = 0;
    for (size_t i = 0; i < a.bytes.size(); ++i) sum += std::abs(double(a.bytes[i]) - double(b.bytes[i]));
    return sum / static_cast<double>(a.bytes.size());
}

inline double deviation(const io::Image8& image) {  ///< standard deviation, of 255
    double sum = 0, squares = 0;
    for (const uint8_t byte : image.bytes) {
        sum += byte;
        squares += double(byte) * byte;
    }
    const double n = static_cast<double>(image.bytes.size());
    return std::sqrt(squares / n - (sum / n) * (sum / n));
}

}  // namespace lucarne::test
