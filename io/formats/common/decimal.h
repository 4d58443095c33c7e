#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>

// Scaled integers as the decimal fractions that they stand for.
namespace lucarne::io::text {

/// Computes integer * scale + offset exactly, where scale and offset are decimal fractions: 63600176 * 0.01
/// is 636001.76 and not 636001.7600000001.
class Decimal {
 public:
    /// Empty if scale or offset has more than 12 decimals, or if a result could have more than 18 digits.
    static std::optional<Decimal> of(double scale, double offset) {
        constexpr int kMostDigits = 12;
        constexpr double kMost = 1e18;
        Decimal decimal;
        for (double power = 1; decimal.digits_ <= kMostDigits; ++decimal.digits_, power *= 10) {
            const double step = std::nearbyint(scale * power), start = std::nearbyint(offset * power);
            if (!(std::abs(step) * 0x1p31 + std::abs(start) < kMost && std::abs(start) < 0x1p53))
                return std::nullopt;
            // Whole numbers and powers of ten are exact, so the two quotients are rounded correctly.
            if (step == 0 || step / power != scale || start / power != offset) continue;
            decimal.step_ = static_cast<int64_t>(step);
            decimal.start_ = static_cast<int64_t>(start);
            decimal.power_ = power;
            return decimal;
        }
        return std::nullopt;
    }

    /// Returns the nearest double. If the sum has at most 15 digits, both numbers of the division are exact.
    double value(int32_t integer) const { return static_cast<double>(integer * step_ + start_) / power_; }

    /// Writes at most 24 characters. Returns the end of the text.
    char* write(int32_t integer, char* to) const {
        const int64_t value = integer * step_ + start_;
        std::array<char, 24> text;
        const auto magnitude = value < 0 ? -static_cast<uint64_t>(value) : static_cast<uint64_t>(value);
        const char* end = std::to_chars(text.data(), text.data() + text.size(), magnitude).ptr;
        const auto length = static_cast<int>(end - text.data());
        if (value < 0) *to++ = '-';
        if (length <= digits_) {
            *to++ = '0';
            if (digits_ > 0) *to++ = '.';
            for (int zeros = digits_ - length; zeros > 0; --zeros) *to++ = '0';
        }
        for (int i = 0; i < length; ++i) {
            if (i > 0 && i == length - digits_) *to++ = '.';
            *to++ = text[static_cast<size_t>(i)];
        }
        return to;
    }

 private:
    int digits_ = 0;  ///< after the decimal point
    int64_t step_ = 0, start_ = 0;
    double power_ = 1;  ///< 10^digits_
};

}  // namespace lucarne::io::text
