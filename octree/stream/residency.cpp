#include "octree/stream/residency.h"

#include <algorithm>
#include <cassert>
#include <condition_variable>
#include <list>
#include <mutex>
#include <optional>
#include <thread>
#include <unordered_map>

#include <fmt/format.h>

#include "io/core/guarded.h"

namespace lucarne::octree {
struct ResidencyBase::State {
    using Events = std::list<AnyEvent>;

    struct Entry {
        uint64_t bytes = 0;       ///< bytes of the cap that a load takes
        uint64_t held_bytes = 0;  ///< bytes of the cap that the resident copy takes
        uint64_t record_bytes = 0;
        uint64_t load_bytes = 0;      ///< bytes reserved in transit for a load: its records and its payload
        uint64_t unpolled_bytes = 0;  ///< bytes of the payload in `unpolled`
        uint64_t last_wanted = 0;     ///< number of the last want() that named the node
        float priority = 0;
        uint32_t count = 0;
        bool held = false, in_flight = false;
        bool ahead = false;     ///< wanted by prefetching cuts only
        bool fetched = false;   ///< prefetched, and not wanted by a frame since
        bool admitted = false;  ///< wanted, and fits the cap together with all more important nodes
        bool lost = false;      ///< it or an ancestor failed to load
        bool stale = false;     ///< the source has a newer version than the one resident or being loaded
        bool known = false;  ///< the caller has polled it as loaded, and no eviction has been reported since
        std::optional<Events::iterator> unpolled;  ///< its loaded or replaced event until that is polled
    };

    State(const NodeSource& its_source, ResidencyOptions its_options, AnyPreparation its_preparation)
        : source(its_source),
          options(std::move(its_options)),
          preparation(std::move(its_preparation)),
          broken(its_source.nodes().size()) {}

    const NodeSource& source;
    const ResidencyOptions options;
    const AnyPreparation preparation;

    mutable std::mutex mutex;
    std::condition_variable work, idle;
    std::unordered_map<uint32_t, Entry> entries;  ///< nodes wanted, resident or being loaded
    std::vector<bool> broken;                     ///< nodes that failed; they are not tried again
    std::vector<uint32_t> queue;                  ///< nodes to load, the most important last
    std::vector<uint32_t> evictable;              ///< resident and not admitted, the next to evict last
    Events events;
    ResidencyStats stats;
    uint64_t wants = 0, bytes_in_flight = 0;
    uint64_t bytes_unpolled = 0;  ///< in transit: being read, being made or not polled
    uint64_t bytes_polled = 0;    ///< of the last poll
    unsigned loads_in_flight = 0;
    std::optional<Error> error;
    bool stop = false;
    std::vector<std::thread> threads;

    void mark_wanted(std::span<const Cut* const> cuts, bool ahead, std::vector<uint32_t>& wanted);
    void order_wanted(std::vector<uint32_t> wanted);
    void admit();
    void drop_unwanted();
    void evict(uint32_t node);
    bool make_room(uint64_t bytes);
    bool transit_full() const;
    bool nothing_moves() const;
    void forget_event(Entry& entry);
    std::optional<uint32_t> next_load();
    std::optional<uint32_t> take_next();
    Result<Events> load(uint32_t node, const Entry& wanted) const;
    void finish_load(uint32_t node, Result<Events>&& loaded);
    void loader();
    bool goes_before(uint32_t a, uint32_t b) const;
};

/// Marks the nodes of the cuts as wanted and appends those not yet named by this want() to `wanted`.
void ResidencyBase::State::mark_wanted(std::span<const Cut* const> cuts, bool ahead,
                                       std::vector<uint32_t>& wanted) {
    const size_t nodes = source.nodes().size();
    for (const Cut* cut : cuts)
        for (const CutNode& wanted_node : cut->nodes) {
            if (wanted_node.node >= nodes) continue;
            Entry& entry = entries[wanted_node.node];
            const bool named = entry.last_wanted == wants;
            if (named && ahead && !entry.ahead) continue;
            if (!named) wanted.push_back(wanted_node.node);
            entry.priority = named ? std::max(entry.priority, wanted_node.priority) : wanted_node.priority;
            entry.ahead = ahead;
            entry.last_wanted = wants;
            if (ahead || !entry.fetched) continue;
            entry.fetched = false;
            stats.ahead_hits += entry.held;
        }
}

/// Moves the wanted nodes into the queue and raises each parent's priority to at least that of its children.
void ResidencyBase::State::order_wanted(std::vector<uint32_t> wanted) {
    const auto nodes = source.nodes();
    std::ranges::sort(wanted, std::greater<>());  // children before parents
    for (const uint32_t node : wanted) {
        Entry& entry = entries[node];
        if (!entry.in_flight) {
            const NodeInfo& info = nodes[node];
            entry.count = info.count;
            entry.record_bytes = source.record_bytes(node);
            entry.load_bytes = entry.record_bytes + preparation.most_bytes(info);
            entry.bytes = options.cost ? options.cost(info) : entry.record_bytes;
        }
        if (const auto parent = entries.find(nodes[node].parent);
            parent != entries.end() && parent->second.last_wanted == wants) {
            if (parent->second.ahead == entry.ahead)
                parent->second.priority = std::max(parent->second.priority, entry.priority);
        }
    }
    queue = std::move(wanted);
}

/// Admits the most important wanted nodes of `queue` that fit together, and leaves those in the queue that
/// must be loaded.
void ResidencyBase::State::admit() {
    const auto nodes = source.nodes();
    std::ranges::sort(queue, [&](uint32_t a, uint32_t b) {
        const Entry &ea = entries.at(a), &eb = entries.at(b);
        if (ea.ahead != eb.ahead) return eb.ahead;
        return ea.priority != eb.priority ? ea.priority > eb.priority : a < b;
    });
    for (auto& [node, entry] : entries) entry.admitted = false;
    std::vector<uint32_t> missing;
    uint64_t total = 0;
    bool full = false;
    stats.refused = 0;
    for (const uint32_t node : queue) {
        Entry& entry = entries.at(node);
        const auto found = entries.find(nodes[node].parent);
        const Entry* parent =
            found != entries.end() && found->second.last_wanted == wants ? &found->second : nullptr;
        entry.lost = broken[node] || (parent && parent->lost);
        if (entry.lost) continue;
        const bool orphan = parent && !parent->admitted;
        const uint64_t bytes = std::max(entry.bytes, entry.held_bytes);
        const bool too_large = bytes > options.memory || entry.load_bytes > options.transit;
        // A node larger than the whole cap never blocks the others. The first other node that does not fit
        // ends the admission: a smaller one after it would take the place of a more important one.
        full |= !orphan && !too_large && bytes > options.memory - total;
        if (orphan || full || too_large) {
            stats.refused += !entry.ahead;
            continue;
        }
        total += bytes;
        entry.admitted = true;
        if ((!entry.held || entry.stale) && !entry.in_flight) missing.push_back(node);
    }
    std::ranges::reverse(missing);
    queue = std::move(missing);
}

/// Drops entries that are neither wanted nor resident nor being loaded. Lists the nodes that may be evicted,
/// the least recently wanted last.
void ResidencyBase::State::drop_unwanted() {
    evictable.clear();
    std::erase_if(entries, [&](const auto& pair) {
        return !pair.second.held && !pair.second.in_flight && pair.second.last_wanted != wants;
    });
    evictable.reserve(entries.size());  // finish_load() adds to it and must not allocate
    for (const auto& [node, entry] : entries)
        if (entry.held && !entry.admitted) evictable.push_back(node);
    std::ranges::sort(evictable, [&](uint32_t a, uint32_t b) { return goes_before(b, a); });
}

bool ResidencyBase::State::goes_before(uint32_t a, uint32_t b) const {
    const Entry &ea = entries.at(a), &eb = entries.at(b);
    if (ea.last_wanted != eb.last_wanted) return ea.last_wanted < eb.last_wanted;
    if (ea.priority != eb.priority) return ea.priority < eb.priority;
    return a > b;  // children before parents
}

/// Drops a loaded or replaced event that the caller has not polled and no longer needs.
void ResidencyBase::State::forget_event(Entry& entry) {
    if (!entry.unpolled) return;
    assert(entry.unpolled_bytes <= bytes_unpolled);
    bytes_unpolled -= entry.unpolled_bytes;
    events.erase(*entry.unpolled);
    entry.unpolled.reset();
}

void ResidencyBase::State::evict(uint32_t node) {
    Entry& entry = entries.at(node);
    assert(entry.held && entry.held_bytes <= stats.bytes_held);
    Events told;  // made first, since it may throw
    if (entry.known) told.push_back({Kind::evicted, node, nullptr});
    forget_event(entry);
    events.splice(events.end(), told);
    entry.known = false;
    stats.bytes_held -= entry.held_bytes;
    stats.nodes_held -= 1;
    stats.evictions += 1;
    entry.held = entry.stale = false;
    entry.held_bytes = 0;
}

bool ResidencyBase::State::make_room(uint64_t bytes) {
    while (stats.bytes_held + bytes_in_flight + bytes > options.memory) {
        if (evictable.empty()) return false;
        evict(evictable.back());
        evictable.pop_back();
    }
    return true;
}

/// Whether the next node of the queue must wait until the caller has polled others.
bool ResidencyBase::State::transit_full() const {
    return bytes_unpolled + bytes_polled + entries.at(queue.back()).load_bytes > options.transit;
}

/// Whether nothing will happen before the caller's next call.
bool ResidencyBase::State::nothing_moves() const {
    return loads_in_flight == 0 && (queue.empty() || transit_full());
}

/// Takes the next node off the queue once there is room for it. Throws if there is no memory to report an
/// eviction; then no node is taken.
std::optional<uint32_t> ResidencyBase::State::next_load() {
    if (queue.empty() || transit_full()) return std::nullopt;
    const uint32_t node = queue.back();
    Entry& entry = entries.at(node);
    if (!make_room(entry.bytes)) {
        // Either loads that are no longer wanted occupy the room until they end, or two copies of a node do
        // not fit.
        if (loads_in_flight > 0 || !entry.stale) return std::nullopt;
        evict(node);
        return next_load();
    }
    queue.pop_back();
    entry.in_flight = true;
    entry.stale = false;
    bytes_in_flight += entry.bytes;
    bytes_unpolled += entry.load_bytes;
    stats.transit_peak = std::max(stats.transit_peak, bytes_unpolled + bytes_polled);
    ++loads_in_flight;
    stats.bytes_peak = std::max(stats.bytes_peak, stats.bytes_held + bytes_in_flight);
    assert(stats.bytes_peak <= options.memory && stats.transit_peak <= options.transit);
    return node;
}

/// Calls next_load() and keeps what it throws as the error to report. In that case the queue is dropped; the
/// next want() makes another.
std::optional<uint32_t> ResidencyBase::State::take_next() {
    auto next = guarded("loading", [&]() -> Result<std::optional<uint32_t>> { return next_load(); });
    if (next) return *next;
    if (!error) error = std::move(next).error();
    queue.clear();
    if (nothing_moves()) idle.notify_all();
    return std::nullopt;
}

/// Applies the result of a load. Allocates nothing, so that it cannot fail.
void ResidencyBase::State::finish_load(uint32_t node, Result<Events>&& loaded) {
    Entry& entry = entries.at(node);
    assert(entry.in_flight && loads_in_flight > 0);
    assert(entry.bytes <= bytes_in_flight && entry.load_bytes <= bytes_unpolled);
    entry.in_flight = false;
    bytes_in_flight -= entry.bytes;
    bytes_unpolled -= entry.load_bytes;
    --loads_in_flight;
    if (!loaded) {
        if (entry.stale) return;  // the node changed during the load: the next want() requests it again
        ++stats.failures;
        ++stats.lost;
        broken[node] = true;
        if (!error) error = std::move(loaded).error();
        return;
    }
    ++stats.loads;
    stats.bytes_loaded += entry.record_bytes;
    entry.fetched = entry.ahead && entry.last_wanted == wants;
    stats.ahead_loads += entry.fetched;
    forget_event(entry);
    entry.unpolled_bytes = loaded->front().payload->bytes;
    bytes_unpolled += entry.unpolled_bytes;
    if (entry.known) loaded->front().kind = Kind::replaced;
    entry.unpolled = loaded->begin();
    events.splice(events.end(), *loaded);
    stats.bytes_held += entry.bytes - entry.held_bytes;
    entry.held_bytes = entry.bytes;
    if (entry.held) return;
    entry.held = true;
    ++stats.nodes_held;
    if (entry.admitted) return;
    const auto later = [&](uint32_t other) { return goes_before(node, other); };
    assert(evictable.size() < evictable.capacity());
    evictable.insert(std::ranges::partition_point(evictable, later), node);
}

/// Reads a node and makes its event. Runs on a loading thread, without the lock.
auto ResidencyBase::State::load(uint32_t node, const Entry& wanted) const -> Result<Events> {
    const std::string name = fmt::format("node {}", node);
    return guarded(name, [&]() -> Result<Events> {
        LUCARNE_ASSIGN(NodeData data, source.load(node));
        if (data.count != wanted.count || data.records.size() != wanted.record_bytes)
            return rejected(name, "its contents differ from its directory entry");
        Events made;
        made.push_back({Kind::loaded, node, preparation.make(node, std::move(data))});
        if (const uint64_t bytes = made.front().payload->bytes; bytes > wanted.load_bytes)
            return failed(name, fmt::format("it takes {} bytes once prepared, but {} were reserved for it",
                                            bytes, wanted.load_bytes));
        return made;
    });
}

void ResidencyBase::State::loader() {
    std::unique_lock lock(mutex);
    while (!stop) {
        const std::optional<uint32_t> node = take_next();
        if (!node) {
            work.wait(lock);
            continue;
        }
        const Entry wanted = entries.at(*node);
        lock.unlock();
        Result<Events> loaded = load(*node, wanted);
        lock.lock();
        finish_load(*node, std::move(loaded));
        work.notify_all();
        if (nothing_moves()) idle.notify_all();
    }
}

ResidencyBase::ResidencyBase(const NodeSource& source, ResidencyOptions options, AnyPreparation prepare)
    : state_(std::make_unique<State>(source, std::move(options), std::move(prepare))) {
    const unsigned threads = std::clamp(state_->options.threads, 1u, 64u);
    for (unsigned i = 0; i < threads; ++i) {
        try {
            state_->threads.emplace_back([state = state_.get()] { state->loader(); });
        } catch (const std::system_error&) {  // one thread is enough, none is not
            if (state_->threads.empty()) throw;
            break;
        }
    }
}

ResidencyBase::~ResidencyBase() {
    {
        const std::lock_guard lock(state_->mutex);
        state_->stop = true;
    }
    state_->work.notify_all();
    for (std::thread& thread : state_->threads) thread.join();
}

void ResidencyBase::want(std::span<const Cut* const> cuts, std::span<const Cut* const> ahead) {
    {
        const std::lock_guard lock(state_->mutex);
        ++state_->wants;
        state_->broken.resize(state_->source.nodes().size());
        std::vector<uint32_t> wanted;
        state_->mark_wanted(cuts, false, wanted);
        state_->mark_wanted(ahead, true, wanted);
        state_->order_wanted(std::move(wanted));
        state_->admit();
        state_->drop_unwanted();
        if (state_->nothing_moves()) state_->idle.notify_all();
    }
    state_->work.notify_all();
}

void ResidencyBase::renew(std::span<const uint32_t> nodes) {
    const std::lock_guard lock(state_->mutex);
    for (const uint32_t node : nodes) {
        if (node < state_->broken.size() && state_->broken[node]) {
            state_->broken[node] = false;
            --state_->stats.lost;
        }
        if (const auto entry = state_->entries.find(node); entry != state_->entries.end())
            entry->second.stale = entry->second.held || entry->second.in_flight;
    }
}

void ResidencyBase::renew_all() {
    const std::lock_guard lock(state_->mutex);
    state_->broken.assign(state_->broken.size(), false);
    state_->stats.lost = 0;
    for (auto& [node, entry] : state_->entries) entry.stale = entry.held || entry.in_flight;
}

auto ResidencyBase::poll_any(size_t limit) -> std::vector<AnyEvent> {
    std::vector<AnyEvent> polled;
    {
        const std::lock_guard lock(state_->mutex);
        state_->bytes_polled = 0;
        while (!state_->events.empty() && polled.size() < limit) {
            AnyEvent& event = state_->events.front();
            if (event.kind != Kind::evicted) {
                State::Entry& entry = state_->entries.at(event.node);
                assert(entry.unpolled == state_->events.begin());
                entry.unpolled.reset();
                entry.known = true;
                state_->bytes_unpolled -= entry.unpolled_bytes;
                state_->bytes_polled += entry.unpolled_bytes;
            }
            polled.push_back(std::move(event));
            state_->events.pop_front();
        }
    }
    state_->work.notify_all();
    return polled;
}

bool ResidencyBase::wait() {
    std::unique_lock lock(state_->mutex);
    state_->idle.wait(lock, [&] { return state_->nothing_moves(); });
    return state_->queue.empty();
}

bool ResidencyBase::wait_for(std::chrono::duration<double> most) {
    std::unique_lock lock(state_->mutex);
    return state_->idle.wait_for(lock, most, [&] { return state_->nothing_moves(); }) &&
           state_->queue.empty();
}

bool ResidencyBase::resident(uint32_t node) const {
    const std::lock_guard lock(state_->mutex);
    const auto entry = state_->entries.find(node);
    return entry != state_->entries.end() && entry->second.held;
}

ResidencyStats ResidencyBase::stats() const {
    const std::lock_guard lock(state_->mutex);
    ResidencyStats stats = state_->stats;
    stats.pending = 0;
    for (const uint32_t node : state_->queue) stats.pending += !state_->entries.at(node).ahead;
    for (const auto& [node, entry] : state_->entries)
        stats.pending += !entry.ahead && ((entry.in_flight && entry.admitted) || entry.unpolled);
    return stats;
}

Result<void> ResidencyBase::take_error() {
    const std::lock_guard lock(state_->mutex);
    if (!state_->error) return {};
    Error error = std::move(*state_->error);
    state_->error.reset();
    return tl::make_unexpected(std::move(error));
}

}  // namespace lucarne::octree
