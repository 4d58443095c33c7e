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
    uint64_t memory = uint64_t{512} << 20;  ///< hard cap on nodes held or on their way, bytes
    /// Hard cap on the records in this process, bytes: being read, not polled yet, or polled last (they count
    /// until the next poll). Loading pauses where it is reached.
    uint64_t transit = uint64_t{256} << 20;
    unsigned threads = 2;  ///< loading threads, 1 to 64
    /// What a node takes of `memory`; empty: the bytes of its records. A caller that copies nodes into pages
    /// of its own (a device's pool) counts those, so that what fits here fits there.
    std::function<uint64_t(const NodeInfo&)> cost;
    /// What an event carries in the place of the records (packed for a device, say), made on a loading
    /// thread so that the caller's need not; empty: the records. In transit it counts as the records do.
    std::function<NodeData(uint32_t node, NodeData&&)> prepare;
};

/// What happened since the last poll, in order. Played back from the start, the nodes loaded and not evicted
/// are at every moment within the cap.
struct ResidencyEvent {
    enum class Kind { loaded, replaced, evicted } kind = Kind::loaded;
    uint32_t node = 0;
    std::shared_ptr<const NodeData> data;  ///< loaded and replaced; the residency keeps no copy of its own
};

struct ResidencyStats {
    uint64_t bytes_held = 0, bytes_loaded = 0;  ///< now; since the start
    uint64_t nodes_held = 0, loads = 0, evictions = 0, failures = 0;
    uint64_t lost = 0;          ///< failed and not tried again, now
    uint64_t pending = 0;       ///< wanted and not there yet, or there and not polled
    uint64_t refused = 0;       ///< wanted, and the caps have no room for them
    uint64_t bytes_peak = 0;    ///< the most ever held or on their way
    uint64_t transit_peak = 0;  ///< the most records ever in this process
    uint64_t ahead_loads = 0;   ///< nodes loaded that were wanted ahead alone
    uint64_t ahead_hits = 0;    ///< of those, wanted for a picture later and still held
};

/// Keeps the nodes of the wanted cuts resident: loads what is missing in the background, most important first
/// (parents before children), evicts the least recently wanted under a hard cap, and reports events. Where
/// the wanted nodes are too large together, the most important that fit are held and the rest refused, so
/// that nothing wanted is ever evicted for something less important. One caller; `cost` and events are on its
/// thread.
class Residency {
 public:
    Residency(const NodeSource& source, ResidencyOptions options);
    ~Residency();  ///< waits for the loads that are being read
    Residency(const Residency&) = delete;
    Residency& operator=(const Residency&) = delete;

    /// Replaces what is wanted: the union of `cuts`, and of `ahead` what finds room beside them, loaded after
    /// them (prefetching). Loads not started that nobody wants any more are dropped; those being read go on.
    void want(std::span<const Cut* const> cuts, std::span<const Cut* const> ahead = {});
    /// These nodes have changed in the source: those held come again as `replaced` (as evicted and loaded
    /// where there is no room for two copies), those that failed are tried once more. Takes effect with the
    /// next want().
    void renew(std::span<const uint32_t> nodes);
    /// Events since the last call; at most `limit`, so that a frame stays short. Never blocks on a load.
    std::vector<ResidencyEvent> poll(size_t limit = SIZE_MAX);
    /// Blocks until everything wanted is loaded, failed or refused by the cap: true. False: the records in
    /// transit are at their cap, and the rest comes when events have been polled.
    bool wait();
    bool resident(uint32_t node) const;
    ResidencyStats stats() const;
    /// The first load that failed since the last call, if any: the caller decides what to tell the user. A
    /// node that failed is not tried again, and its descendants are not wanted.
    Result<void> take_error();

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace lucarne::octree
