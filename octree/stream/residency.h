#pragma once

#include <chrono>
#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "octree/stream/cut.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

struct ResidencyOptions {
    uint64_t memory = uint64_t{512} << 20;  ///< hard cap on nodes resident or being loaded, bytes
    /// Hard cap on records and payloads in this process, bytes: being read or made, not yet polled, or polled
    /// last (they count until the next poll). Loading pauses at the cap.
    uint64_t transit = uint64_t{256} << 20;
    unsigned threads = 2;  ///< loading threads, 1 to 64
    /// Returns how many bytes of `memory` a node takes; empty: the bytes of its records. A caller that copies
    /// nodes into pages of its own (a device's pool) counts those pages, so that what fits here fits there.
    std::function<uint64_t(const NodeInfo&)> cost;
};

struct ResidencyStats {
    uint64_t bytes_held = 0;    ///< now, of `memory`
    uint64_t bytes_loaded = 0;  ///< of records, since the start
    uint64_t nodes_held = 0, loads = 0, evictions = 0, failures = 0;
    uint64_t lost = 0;          ///< nodes that failed and are not tried again
    uint64_t pending = 0;       ///< wanted and not resident yet, or resident and not polled
    uint64_t refused = 0;       ///< wanted, but the caps have no room for them
    uint64_t bytes_peak = 0;    ///< the most bytes ever resident or being loaded
    uint64_t transit_peak = 0;  ///< the most bytes of records and payloads ever in this process
    uint64_t ahead_loads = 0;   ///< nodes loaded that only prefetching wanted
    uint64_t ahead_hits = 0;    ///< those of them that a frame wanted later while they were resident
};

/// Returns the bytes that a payload has allocated, unused capacity included. A payload of another type has an
/// overload in its own namespace.
template <class T>
requires std::is_trivially_copyable_v<T> uint64_t allocated_bytes(const std::vector<T>& payload) {
    return uint64_t{payload.capacity()} * sizeof(T);
}
inline uint64_t allocated_bytes(const NodeData& payload) {
    return allocated_bytes(payload.records);
}

/// How a node becomes a payload, for example surfels packed for a device.
template <class Payload>
struct Preparation {
    /// Makes the payload. Runs on the loading threads, so that the caller's thread need not do it.
    std::function<Payload(uint32_t node, NodeData&&)> make;
    /// Returns the most bytes that make() allocates for a node. They are reserved in transit before the node
    /// is read. A payload that has allocated more than these and the records together is an error of its
    /// node.
    std::function<uint64_t(const NodeInfo&)> most_bytes;
};

/// The part of a Residency that does not depend on the type of its payload.
class ResidencyBase {
 public:
    enum class Kind { loaded, replaced, evicted };

    ResidencyBase(const ResidencyBase&) = delete;
    ResidencyBase& operator=(const ResidencyBase&) = delete;

    /// Replaces the set of wanted nodes: the union of `cuts` and, as far as room is left, of `ahead`, which
    /// is loaded after them (prefetching). Loads of nodes that are no longer wanted are dropped if not
    /// started, else they continue.
    void want(std::span<const Cut* const> cuts, std::span<const Cut* const> ahead = {});
    /// Says that these nodes have changed in the source. Resident ones are loaded again and reported as
    /// `replaced` (as evicted and loaded where two copies do not fit); failed ones are tried once more. Takes
    /// effect with the next want().
    void renew(std::span<const uint32_t> nodes);
    /// The same for all nodes.
    void renew_all();
    /// Blocks until every wanted node is loaded, failed or refused by the cap, and then returns true. Returns
    /// false if what is in transit has reached its cap: loading continues when events have been polled.
    bool wait();
    /// Likewise, but also returns false once this time has passed.
    bool wait_for(std::chrono::duration<double> most);
    bool resident(uint32_t node) const;
    ResidencyStats stats() const;
    /// Returns the first load error since the last call, if any; the caller decides what to tell the user. A
    /// failed node is not tried again, and its descendants are not loaded.
    Result<void> take_error();

 protected:
    struct AnyPayload {
        virtual ~AnyPayload() = default;
        uint64_t bytes = 0;  ///< allocated by the payload
    };
    struct AnyEvent {
        Kind kind = Kind::loaded;
        uint32_t node = 0;
        std::unique_ptr<AnyPayload> payload;
    };
    using AnyPreparation = Preparation<std::unique_ptr<AnyPayload>>;

    ResidencyBase(const NodeSource& source, ResidencyOptions options, AnyPreparation prepare);
    ~ResidencyBase();
    std::vector<AnyEvent> poll_any(size_t limit);

 private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Keeps the nodes of the wanted cuts resident. Loads missing nodes in the background, the most important
/// first (parents before children), evicts the least recently wanted under a hard cap, and reports events. If
/// the wanted nodes do not fit together, keeps the most important ones and refuses the rest, so no wanted
/// node is ever evicted for a less important one. All calls must come from one thread; `cost` and
/// `most_bytes` run on it, too.
///
/// A loaded node is a Payload: any type that can be moved and that has allocated_bytes(), see above.
template <class Payload = NodeData>
class Residency : public ResidencyBase {
 public:
    /// What happened to a node. At every moment of a replay of all events from the start, the nodes loaded
    /// and not evicted are within the cap.
    struct Event {
        Kind kind = Kind::loaded;
        uint32_t node = 0;
        std::optional<Payload> data;  ///< of loaded and replaced; the residency keeps no copy
    };

    Residency(const NodeSource& source, ResidencyOptions options, Preparation<Payload> prepare)
        : ResidencyBase(source, std::move(options), erased(std::move(prepare))) {}
    /// Hands out the records as they are.
    Residency(const NodeSource& source, ResidencyOptions options) requires std::same_as<Payload, NodeData>
        : Residency(source, std::move(options), records()) {}
    /// Waits for the loads in progress.
    ~Residency() = default;

    /// Returns the events since the last call in order, at most `limit`, so that a frame stays short. Never
    /// waits for a load.
    std::vector<Event> poll(size_t limit = SIZE_MAX) {
        std::vector<AnyEvent> polled = poll_any(limit);
        std::vector<Event> events(polled.size());
        for (size_t i = 0; i < polled.size(); ++i) {
            events[i].kind = polled[i].kind;
            events[i].node = polled[i].node;
            if (polled[i].payload) events[i].data = std::move(static_cast<Typed&>(*polled[i].payload).value);
        }
        return events;
    }

 private:
    struct Typed : AnyPayload {
        explicit Typed(Payload&& made) : value(std::move(made)) { bytes = allocated_bytes(value); }
        Payload value;
    };

    static AnyPreparation erased(Preparation<Payload> prepare) {
        return {[make = std::move(prepare.make)](uint32_t node, NodeData&& data) {
                    return std::make_unique<Typed>(make(node, std::move(data)));
                },
                std::move(prepare.most_bytes)};
    }
    static Preparation<NodeData> records() {
        return {[](uint32_t, NodeData&& data) {
                    data.records.shrink_to_fit();
                    return std::move(data);
                },
                [](const NodeInfo&) { return uint64_t{0}; }};
    }
};

Residency(const NodeSource&, ResidencyOptions)->Residency<NodeData>;

}  // namespace lucarne::octree
