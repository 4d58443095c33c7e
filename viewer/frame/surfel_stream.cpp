#include "viewer/frame/surfel_stream.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "io/core/log.h"
#include "io/core/options.h"

namespace lucarne::viewer {
namespace {

constexpr size_t kNodesAtOnce = 8;  // nodes accepted between two looks at the clock
// Share of the device's memory for surfels. The shadow maps hold the light cut's surfels a second time;
// pictures and maps take the rest.
constexpr double kPoolShare = 0.375;
constexpr double kFilledShare = 0.25;                  // of the pool: the most that synthetic surfels take
constexpr uint64_t kLeastTransit = uint64_t{1} << 20;  // enough for some nodes of usual size

uint64_t pool_bytes(uint64_t surfels) {
    return uint64_t{gi::pages_for(surfels)} * gi::kPageSurfels * sizeof(gi::PackedSurfel);
}

}  // namespace

/// Returns the size of the pool: what the caps allow, but at most the whole cloud.
uint64_t SurfelStream::pool_surfels() const {
    const auto share = static_cast<uint64_t>(kPoolShare * static_cast<double>(caps_.device_memory));
    const uint64_t most = std::min(share, device_.info().max_texel_bytes);
    uint64_t whole = filled_bytes(), largest = 0;
    for (const octree::NodeInfo& node : source_->nodes()) {
        whole += pool_bytes(node.count);
        largest = std::max(largest, pool_bytes(node.count));
        if (whole >= most) break;  // further nodes of a large cloud change nothing
    }
    // Room for recoloured nodes that arrive before the old ones are freed.
    whole += (caps_.load_threads + 1) * largest;
    return std::min<uint64_t>(std::min(whole, most) / sizeof(gi::PackedSurfel), UINT32_MAX);
}

void SurfelStream::empty_pool() {
    residency_.reset();
    pool_.evict_all();
}

/// Bytes of the pool that the synthetic surfels take.
uint64_t SurfelStream::filled_bytes() const {
    uint64_t bytes = 0;
    for (const octree::Filling& filling : fillings_)
        for (const octree::NodeInfo& node : filling.nodes) bytes += pool_bytes(node.count);
    return bytes;
}

/// Loads the source's synthetic surfels, for load_fillings(). Without them there are holes, but a picture.
void SurfelStream::take_fillings() {
    fillings_.clear();
    auto loaded = source_->fillings();
    if (loaded)
        fillings_ = std::move(*loaded);
    else
        log::warn("{}; holes of the scan stay open", loaded.error().line());
}

/// Packs the synthetic surfels for the device.
Result<void> SurfelStream::load_fillings() {
    uint32_t number = gi::kFirstFilled;
    for (const octree::Filling& filling : fillings_)
        for (uint32_t node = 0; node < filling.nodes.size(); ++node) {
            LUCARNE_ASSIGN(const bool fits, pool_.load(number++, preparation_->pack(filling, node)));
            if (!fits) return failed("surfel pool", "the stream holds more nodes than fit");
        }
    cuts_.tear();
    return {};
}

Result<void> SurfelStream::set_source(std::shared_ptr<const octree::NodeSource> from,
                                      const gi::Scene& scene) {
    if (const uint64_t bytes = from->directory_bytes(); caps_.memory < bytes + kLeastTransit)
        return bad_arguments("--memory",
                             fmt::format("{} are too little: the directory of the octree alone takes {}",
                                         bytes_text(caps_.memory), bytes_text(bytes)),
                             "allow more");
    empty_pool();
    source_ = std::move(from);
    baked_.reset();
    take_fillings();
    const uint64_t capacity = pool_surfels();
    if (capacity > pool_.capacity()) {
        pool_ = {};
        LUCARNE_ASSIGN(pool_, gi::SurfelPool::create(device_, static_cast<uint32_t>(capacity)));
    }
    start(scene);
    return {};
}

/// Starts the stream with nothing resident. What fits the stream's cap also fits the pool, because a node
/// costs the same pages in both.
void SurfelStream::start(const gi::Scene& scene) {
    empty_pool();
    if (static_cast<double>(filled_bytes()) >
        kFilledShare * static_cast<double>(pool_bytes(pool_.capacity()))) {
        log::warn("there is too little device memory to fill the holes of the scan");
        fillings_.clear();
    }
    octree::ResidencyOptions how;
    how.memory = pool_bytes(pool_.capacity()) - filled_bytes();
    how.transit = caps_.memory - source_->directory_bytes();
    how.threads = caps_.load_threads;
    how.cost = [](const octree::NodeInfo& node) { return pool_bytes(node.count); };
    preparation_ = std::make_shared<gi::SurfelPreparation>(source_, scene);
    octree::Preparation<gi::PackedNode> pack;
    pack.make = [packing = preparation_](uint32_t node, octree::NodeData&& data) {
        return packing->pack(node, data);
    };
    pack.most_bytes = [](const octree::NodeInfo& node) {
        return uint64_t{node.count} * sizeof(gi::PackedSurfel);
    };
    stale_ = true;
    residency_ = std::make_unique<Stream>(*source_, how, std::move(pack));
    cuts_.tear();
}

Result<void> SurfelStream::renew(const gi::Scene& scene) {
    if (!std::exchange(stale_, false)) return {};
    ++packing_;
    values_ = gi::measured_values(*source_, scene.look);
    gi::Scene shown = scene;
    shown.look.range = values_.range;
    if (scene.albedo.flatten > 0 && !baked_) {
        LUCARNE_ASSIGN(baked_, gi::BakedLight::measured(*source_));
    }
    preparation_->set_scene(shown, baked_ ? &*baked_ : nullptr);
    LUCARNE_TRY(load_fillings());
    residency_->renew_all();
    return {};
}

bool SurfelStream::shrink(const gi::Scene& scene) {
    const uint64_t capacity = uint64_t{pool_.capacity()} * 3 / 4;
    if (capacity < pool_surfels() / 16 + gi::SurfelPool::kPageSurfels) return false;
    pool_ = {};
    auto smaller = gi::SurfelPool::create(device_, static_cast<uint32_t>(capacity));
    if (!smaller) return false;
    pool_ = std::move(*smaller);
    start(scene);
    return true;
}

CutRoom SurfelStream::room() const {
    return {pool_bytes(pool_.capacity()) - filled_bytes(),
            [](const octree::NodeInfo& node) { return pool_bytes(node.count); }};
}

/// Applies the stream's events to the device.
Result<void> SurfelStream::apply(std::span<const Stream::Event> events) {
    for (const Stream::Event& event : events) {
        cuts_.changed();
        if (event.kind != Stream::Kind::loaded) {
            pool_.evict(event.node);
            cuts_.node_gone(event.node);
        }
        if (event.kind == Stream::Kind::evicted) continue;
        bytes_loaded_ += source_->nodes()[event.node].payload_bytes;
        LUCARNE_ASSIGN(const bool fits, pool_.load(event.node, *event.data));
        if (!fits) return failed("surfel pool", "the stream holds more nodes than fit");
    }
    return {};
}

/// Accepts nodes that have arrived, for so many seconds.
Result<void> SurfelStream::take_arrivals(double seconds) {
    const auto start = std::chrono::steady_clock::now();
    for (;;) {
        const auto events = residency_->poll(kNodesAtOnce);
        LUCARNE_TRY(apply(events));
        const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
        if (events.empty() || spent.count() > seconds) return {};
    }
}

Result<void> SurfelStream::load(const std::vector<const octree::Cut*>& wanted,
                                const std::vector<const octree::Cut*>& later, double seconds,
                                double patience) {
    residency_->want(wanted, later);
    if (patience > 0) residency_->wait_for(std::chrono::duration<double>(patience));
    return take_arrivals(seconds);
}

Result<void> SurfelStream::load_all(const std::vector<const octree::Cut*>& wanted) {
    residency_->want(wanted, {});
    for (bool all = false; !all;) {
        all = residency_->wait();
        LUCARNE_TRY(take_arrivals(INFINITY));
    }
    return {};
}

}  // namespace lucarne::viewer
