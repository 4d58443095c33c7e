#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "octree/tree/key.h"

namespace lucarne::octree {

/// Finds, among disjoint cubes of kMaxLevel or above in Morton order, the one that contains a place.
class GivenCubes {
 public:
    explicit GivenCubes(std::span<const NodeKey> keys) : keys_(keys.begin(), keys.end()) {
        for (const NodeKey& key : keys_) {
            begins_.push_back(at_finest(key, key.code()));
            ends_.push_back(at_finest(key, key.code() + 1));
        }
    }
    size_t size() const { return keys_.size(); }
    const NodeKey& key(size_t cube) const { return keys_[cube]; }
    /// Returns size() for a place outside all of them.
    size_t of(const Place& place) const {
        const uint64_t code = place.code();
        const auto behind = std::upper_bound(begins_.begin(), begins_.end(), code) - begins_.begin();
        const auto cube = static_cast<size_t>(behind) - 1;
        return behind > 0 && code < ends_[cube] ? cube : size();
    }

 private:
    static uint64_t at_finest(const NodeKey& key, uint64_t code) {
        return code << 3 * (kMaxLevel - key.level);
    }

    std::vector<NodeKey> keys_;
    std::vector<uint64_t> begins_, ends_;  ///< Morton codes of kMaxLevel
};

}  // namespace lucarne::octree
