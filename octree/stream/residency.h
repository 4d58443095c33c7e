#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "octree/source.h"
#include "octree/stream/cut.h"

namespace lucarne::octree {

struct ResidencyOptions {
    uint64_t memory = uint64_t{512} << 20;  ///< hard cap on node data held or on its way, bytes
    unsigned threads = 2;                   ///< loading threads
};

/// What happened since the last poll, in order. `replaced` is for sources whose nodes grow.
struct ResidencyEvent {
    enum class Kind { loaded, replaced, evicted } kind = Kind::loaded;
    uint32_t node = 0;
    std::shared_ptr<const NodeData> data;  ///< loaded and replaced
};

struct ResidencyStats {
    uint64_t bytes_held = 0, bytes_loaded = 0;  ///< now; since the start
    uint64_t nodes_held = 0, loads = 0, evictions = 0, failures = 0;
    uint64_t pending = 0;                       ///< wanted and not there yet
};

/// Keeps the nodes of the wanted cuts resident: loads what is missing in the background, most important first
/// (parents before children), evicts the least recently wanted under a hard cap, and reports events. One caller.
class Residency {
 public:
    Residency(const NodeSource& source, const ResidencyOptions& options);
    ~Residency();
    Residency(const Residency&) = delete;
    Residency& operator=(const Residency&) = delete;

    /// Replaces what is wanted: the union of `cuts`. Loads not started that nobody wants any more are dropped.
    void want(std::span<const Cut* const> cuts);
    /// Events since the last call; at most `limit`, so that a frame stays short. Never blocks on a load.
    std::vector<ResidencyEvent> poll(size_t limit = SIZE_MAX);
    /// Blocks until everything wanted is loaded, failed or refused by the cap; events wait for poll().
    void wait();
    bool resident(uint32_t node) const;
    ResidencyStats stats() const;
    /// The first load that failed since the last call, if any: the caller decides what to tell the user.
    Result<void> take_error();

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace lucarne::octree
