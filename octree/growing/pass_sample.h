#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

namespace lucarne::octree {

/// Keeps points of a pass over all points, each with the same probability, without knowing how many will
/// come. Which ones depends only on their order. One thread adds points; another may look at them.
class PassSample {
 public:
    /// `expected`: how many points will come, 0 if unknown. Less is thrown away if it is right.
    PassSample(uint32_t stride, uint64_t most, uint64_t expected);

    void add(std::span<const std::byte> records);
    /// Returns records of the points that have come so far, in their order: about as many as would be
    /// `of_all` if all had come (of those so far, if it is unknown how many will come). What one call returns
    /// is part of what a later one returns, as long as no more points came than were expected.
    std::vector<std::byte> some(uint64_t of_all) const;
    /// Returns the records that were kept, in the order in which they came: at most `most`, all of them if no
    /// more came and `expected` was not larger, else at least some half of `most`.
    std::vector<std::byte> take();

 private:
    void thin_out();

    uint32_t stride_;
    uint64_t most_, expected_;
    mutable std::mutex mutex_;  ///< guards the members below
    uint64_t limit_;            ///< a point is kept if its number is below; up to 2^32
    uint64_t seen_ = 0;
    std::vector<uint32_t> numbers_;  ///< of the points that are kept
    std::vector<std::byte> records_;
};

}  // namespace lucarne::octree
