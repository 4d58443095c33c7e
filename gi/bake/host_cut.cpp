#include "gi/bake/host_cut.h"

#include <xxhash.h>

#include "gi/surfels/cut_parts.h"

namespace lucarne::gi {
namespace {

template <class T>
uint64_t hash(uint64_t seed, const T& value) {
    return XXH3_64bits_withSeed(&value, sizeof(value), seed);
}

/// Packed surfels of many nodes, in pages of kPageSurfels.
class HostPool {
 public:
    /// Adds a node's surfels.
    void add(uint32_t node, const PackedNode& packed) {
        PlacedNode& place = placed_[node];
        place.count = static_cast<uint32_t>(packed.size());
        place.content = content_of(packed);
        for (uint32_t page = 0; page < pages_for(packed.size()); ++page)
            place.pages.push_back(static_cast<uint32_t>(surfels_.size() / kPageSurfels) + page);
        surfels_.insert(surfels_.end(), packed.begin(), packed.end());
        surfels_.resize(surfels_.size() + (kPageSurfels - surfels_.size() % kPageSurfels) % kPageSurfels);
    }
    const PlacedNodes& placed() const { return placed_; }
    std::span<const PackedSurfel> of(const CutBlock& block) const {
        return std::span(surfels_).subspan(block.first, block.count);
    }

 private:
    std::vector<PackedSurfel> surfels_;
    PlacedNodes placed_;
};

void add_hashes(HostCut& cut) {
    for (const Surfel& s : cut.surfels) {
        cut.shapes = hash(cut.shapes, s.position);
        cut.shapes = hash(cut.shapes, s.normal);
        cut.shapes = hash(cut.shapes, s.radius);
        cut.shapes = hash(cut.shapes, s.area);
        cut.colours = hash(cut.colours, s.albedo);
        cut.colours = hash(cut.colours, s.material);
    }
}

}  // namespace

Result<HostCut> load_host_cut(const octree::NodeSource& source, const octree::Cut& cut,
                              const LocalFrame& frame, const SurfelPreparation& preparation, const Clip& clip,
                              std::span<const octree::Filling> fillings, const std::atomic<bool>* stop) {
    HostPool pool;
    std::vector<CutEntry> entries;
    for (const octree::CutNode& node : cut.nodes) {
        if (stop && stop->load(std::memory_order_relaxed)) return failed("surfels", "given up");
        LUCARNE_ASSIGN(const octree::NodeData data, source.load(node.node));
        pool.add(node.node, preparation.pack(node.node, data));
        entries.push_back({node.node, node.count});
    }
    const auto drawn = fillings_of(fillings, cut.points);
    uint32_t number = kFirstFilled;
    for (const octree::Filling& filling : drawn)
        for (uint32_t node = 0; node < filling.nodes.size(); ++node)
            pool.add(number++, preparation.pack(filling, node));
    const CutParts parts = cut_parts(source, entries, frame.origin, pool.placed(), clip, drawn);
    const auto& header = source.header();
    HostCut result;
    result.frame = frame;
    result.bounds = {frame.to_local(header.min), frame.to_local(header.max)};
    result.surfels.reserve(parts.surfels);
    for (const CutBlock& block : parts.blocks) {
        const CutItem& item = parts.items[block.item];
        for (const PackedSurfel& packed : pool.of(block)) {
            const Surfel surfel = unpack(parts.items, item, packed);
            if (!item.clip || parts.clip.keeps(surfel.position)) result.surfels.push_back(surfel);
        }
    }
    add_hashes(result);
    return result;
}

}  // namespace lucarne::gi
