#include "octree/cluster/rounds.h"

#include <algorithm>

namespace lucarne::octree {
namespace {

constexpr uint64_t kParcelShare = 4;  ///< the parcels of a round have this part of the memory
/// Larger ones do not stay in a processor's cache while they are sorted and written.
constexpr uint64_t kLeastParcel = 64 << 10, kMostParcel = 2 << 20;

}  // namespace

Rounds::Rounds(Ranks& ranks, uint64_t bytes, Receive receive)
    : ranks_(ranks),
      most_(std::clamp(bytes / kParcelShare / ranks.count(), kLeastParcel, kMostParcel)),
      receive_(std::move(receive)) {
    start();
}

Result<void> Rounds::finish() {
    do LUCARNE_TRY(round(true));
    while (!all_done_);
    return {};
}

void Rounds::start() {
    parcels_.resize(ranks_.count());
    for (Ranks::Bytes& parcel : parcels_) {
        parcel.reserve(most_);
        parcel.assign(1, std::byte{0});
    }
}

Result<void> Rounds::round(bool last) {
    for (Ranks::Bytes& parcel : parcels_) parcel[0] = std::byte{last};
    LUCARNE_TRY(ranks_.exchange(parcels_, received_));
    all_done_ = true;
    for (size_t sender = 0; sender < received_.size(); ++sender) {
        all_done_ = all_done_ && received_[sender][0] == std::byte{1};
        LUCARNE_TRY(receive_(sender, std::span(received_[sender]).subspan(1)));
    }
    start();
    return {};
}

}  // namespace lucarne::octree
