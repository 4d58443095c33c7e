#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "octree/stream/cut.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

struct ResidencyOptions {
    uint64_t memory = uint64_t{512} << 20;  ///< hard cap on nodes resident or being loaded, bytes
    /// Hard cap on the records in this process, bytes: being read, not yet polled, or polled last (they count
    /// until the next poll). Loading pauses at the cap.
    uint64_t transit = uint64_t{256} << 20;
    unsigned threads = 2;  ///< loading threads, 1 to 64
    /// Returns how many bytes of `memory` a node takes; empty: the bytes of its records. A caller that copies
    /// nodes into pages of its own (a device's pool) counts those pages, so that what fits here fits there.
    std::function<uint64_t(const NodeInfo&)> cost;
    /// Converts the records that an event carries (packs them for a device, for example) on a loading thread,
    /// so that the caller's thread need not; empty: events carry the records. The result counts as much in
    /// transit as the records.
    std::function<NodeData(uint32_t node, NodeData&&)> prepare;
};

/// What happened since the last poll, in order. At every moment of a replay from the start, the nodes loaded
/// and not evicted are within the cap.
struct ResidencyEvent {
    enum class Kind { loaded, replaced, evicted } kind = Kind::loaded;
    uint32_t node = 0;
    std::shared_ptr<const NodeData> data;  ///< of loaded and replaced; the residency keeps no copy
};

struct ResidencyStats {
    uint64_t bytes_held = 0, bytes_loaded = 0;  ///< now; since the start
    uint64_t nodes_held = 0, loads = 0, evictions = 0, failures = 0;
    uint64_t lost = 0;          ///< nodes that failed and are not tried again
    uint64_t pending = 0;       ///< wanted and not resident yet, or resident and not polled
    uint64_t refused = 0;       ///< wanted, but the caps have no room for them
    uint64_t bytes_peak = 0;    ///< the most bytes ever resident or being loaded
    uint64_t transit_peak = 0;  ///< the most record bytes ever in this process
    uint64_t ahead_loads = 0;   ///< nodes loaded that only prefetching wanted
    uint64_t ahead_hits = 0;    ///< those of them that a frame wanted later while they were resident
};

/// Keeps the nodes of the wanted cuts resident. Loads missing nodes in the background, the most important
/// first (parents before children), evicts the least recently wanted under a hard cap, and reports events. If
/// the wanted nodes do not fit together, keeps the most important ones and refuses the rest, so no wanted
/// node is ever evicted for a less important one. All calls must come from one thread; `cost` runs on it,
/// too.
class Residency {
 public:
    Residency(const NodeSource& source, ResidencyOptions options);
    ~Residency();  ///< waits for the loads in progress
    Residency(const Residency&) = delete;
    Residency& operator=(const Residency&) = delete;

    /// Replaces the set of wanted nodes: the union of `cuts` and, as far as room is left, of `ahead`, which
    /// is loaded after them (prefetching). Loads of nodes that are no longer wanted are dropped if not
    /// started, else they continue.
    void want(std::span<const Cut* const> cuts, std::span<const Cut* const> ahead = {});
    /// Says that these nodes have changed in the source. Resident ones are loaded again and reported as
    /// `replaced` (as evicted and loaded where two copies do not fit); failed ones are tried once more. Takes
    /// effect with the next want().
    void renew(std::span<const uint32_t> nodes);
    /// Returns the events since the last call, at most `limit`, so that a frame stays short. Never waits for
    /// a load.
    std::vector<ResidencyEvent> poll(size_t limit = SIZE_MAX);
    /// Blocks until every wanted node is loaded, failed or refused by the cap, and then returns true. Returns
    /// false if the records in transit have reached their cap: loading continues when events have been
    /// polled.
    bool wait();
    bool resident(uint32_t node) const;
    ResidencyStats stats() const;
    /// Returns the first load error since the last call, if any; the caller decides what to tell the user. A
    /// failed node is not tried again, and its descendants are not loaded.
    Result<void> take_error();

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace lucarne::octree
