#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lucarne::io::text {

constexpr bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// Parses the decimal number at `at`. Its text ends at `end`, or without `end` at any character that does not
/// belong to a number. Returns its end. Returns nullptr if it has an exponent or too many digits or is no
/// number; use parse_number then. Exact: whole numbers up to 2^53 and powers of ten up to 10^22 are doubles,
/// so that one division rounds correctly (Clinger, "How to Read Floating Point Numbers Accurately", 1990).
inline const char* plain_number(const char* at, double& value, const char* end = nullptr) {
    constexpr std::array<double, 23> kPowers = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    constexpr int kMostDigits = 18;  // fit 64 bits
    const auto is = [&](char c) { return at != end && *at == c; };
    const bool negative = is('-');
    at += negative || is('+');
    uint64_t digits = 0;
    const char* first = at;
    for (; at != end && is_digit(*at); ++at) digits = digits * 10 + static_cast<uint64_t>(*at - '0');
    auto count = at - first;
    std::ptrdiff_t decimals = 0;
    if (is('.')) {
        const char* point = at++;
        for (; at != end && is_digit(*at); ++at) digits = digits * 10 + static_cast<uint64_t>(*at - '0');
        decimals = at - point - 1;
        count += decimals;
    }
    if (count == 0 || count > kMostDigits || digits > (uint64_t{1} << 53) || is('e') || is('E'))
        return nullptr;
    const double size = static_cast<double>(digits) / kPowers[static_cast<size_t>(decimals)];
    value = negative ? -size : size;
    return at;
}

}  // namespace lucarne::io::text
