#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lucarne::octree {

inline constexpr uint8_t kLastPass = 31;

/// Appends to `order` the indices of the points whose pass is at least `from`: pass by pass, and within a
/// pass in bit-reversed rank (van der Corput along the points' Morton order), so that every prefix is even.
/// Passes are at most kLastPass.
void append_prefix_order(std::span<const uint8_t> passes, uint8_t from, std::vector<uint32_t>& order);

}  // namespace lucarne::octree
