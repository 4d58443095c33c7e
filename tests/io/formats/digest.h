#pragma once

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/io/io_testing.h"

namespace lucarne::io::testing {

/// Returns the 64 bits of a number: integers sign-extended, floats as doubles.
inline uint64_t bits_of(ScalarType type, const std::byte* at) {
    switch (type) {
        case ScalarType::u64:
        case ScalarType::i64:
            return load<uint64_t>(at);
        case ScalarType::f32:
        case ScalarType::f64: {
            const double value = scalar_at(type, at);
            uint64_t bits = 0;
            std::memcpy(&bits, &value, sizeof bits);
            return bits;
        }
        default:
            return static_cast<uint64_t>(static_cast<int64_t>(scalar_at(type, at)));
    }
}

/// Returns the sum of the bits and the sum weighted by position, modulo 2^64, like tests/oracles/digest.py.
inline nlohmann::json digest(const Records& records, size_t stride, size_t offset, ScalarType type) {
    uint64_t sum = 0, placed = 0;
    for (size_t i = 0; i < records.count; ++i) {
        const uint64_t bits = bits_of(type, &records.bytes[i * stride + offset]);
        sum += bits;
        placed += (i + 1) * bits;
    }
    return {fmt::format("{:016x}", sum), fmt::format("{:016x}", placed)};
}

}  // namespace lucarne::io::testing
