#pragma once

#include <cstdint>

namespace lucarne {

/// SplitMix64's finalizer (Steele, Lea, Flood 2014): a bijective mix of 64 bits. It serves as a counter-based
/// random generator: every number follows from (seed, index), whatever the number of threads.
constexpr uint64_t mix64(uint64_t x) {
    x += 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

constexpr uint64_t mix64(uint64_t seed, uint64_t index) {
    return mix64(mix64(seed) ^ index);
}

/// Converts a mixed word to a number uniform in [0, 1), from its upper 53 bits.
constexpr double unit_double(uint64_t mixed) {
    return static_cast<double>(mixed >> 11) * 0x1.0p-53;
}

/// A small sequential generator over mix64. (seed, stream) selects its stream.
class Random {
 public:
    explicit constexpr Random(uint64_t seed, uint64_t stream = 0) : key_(mix64(seed, stream)) {}
    constexpr uint64_t next() { return mix64(key_ ^ (0x632be59bd9b4e019ull * ++counter_)); }
    constexpr double uniform() { return unit_double(next()); }

 private:
    uint64_t key_, counter_ = 0;
};

}  // namespace lucarne
