#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "octree/cluster/ranks.h"

namespace lucarne::octree {

/// Sends a stream of bytes to each rank, in rounds that all ranks make together, so that nobody receives more
/// than a share of its memory at a time. All ranks call finish() once.
class Rounds {
 public:
    /// Gets what a rank sent in a round.
    using Receive = std::function<Result<void>(size_t sender, std::span<const std::byte> bytes)>;

    /// `bytes`: of memory; the parcels of a round have a part of it.
    Rounds(Ranks& ranks, uint64_t bytes, Receive receive);

    /// Bytes that can still be added for a rank in this round.
    uint64_t room(size_t rank) const { return most_ - parcels_[rank].size(); }
    /// Adds bytes for a rank. They must have room.
    void add(size_t rank, std::span<const std::byte> bytes) {
        Ranks::Bytes& parcel = parcels_[rank];
        parcel.insert(parcel.end(), bytes.begin(), bytes.end());
    }
    /// Sends what was added. A meeting.
    Result<void> next() { return round(false); }
    /// Sends the rest, and receives until all ranks have finished. A meeting.
    Result<void> finish();

 private:
    void start();
    Result<void> round(bool last);

    Ranks& ranks_;
    uint64_t most_;  ///< bytes of a parcel
    Receive receive_;
    /// A parcel begins with a byte that tells whether it is the sender's last one.
    std::vector<Ranks::Bytes> parcels_, received_;
    bool all_done_ = false;
};

}  // namespace lucarne::octree
