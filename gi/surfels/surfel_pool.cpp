#include "gi/surfels/surfel_pool.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <span>
#include <utility>

#include "gi/shared/cut_bindings.h"

namespace lucarne::gi {
namespace {

constexpr uint32_t kMostDownloaded = 1 << 16;  // surfels by one call, 1 MiB

}  // namespace

std::optional<PointPlace> CutPoints::find(uint32_t id) const {
    const uint32_t block = id / kBlockSurfels;
    const auto after = std::ranges::upper_bound(runs_, block, {}, &CutParts::Run::first_block);
    if (after == runs_.begin()) return std::nullopt;
    const CutParts::Run& run = *(after - 1);
    const uint32_t index = id - run.first_block * kBlockSurfels;
    if (index >= run.count) return std::nullopt;
    return PointPlace{run.node, index};
}

void DeviceCut::bind() const {
    assert(pool_);  // set by make_cut()
    pool_->bind_texels(kUnitCutPool, TexelView::four_words);
    items_.bind_texels(kUnitCutItems, TexelView::four_words);
    blocks_buffer_.bind_texels(kUnitCutBlocks, TexelView::four_words);
}

const HostSurfels& DeviceCut::on_host(std::span<const PackedSurfel> pool) const {
    if (!on_host_) on_host_ = host_surfels(*this, pool);
    return *on_host_;
}

Result<SurfelPool> SurfelPool::create(Device& device, uint32_t capacity) {
    const uint64_t most = uint64_t{UINT32_MAX} / kPageSurfels;
    const auto pages = static_cast<uint32_t>(std::clamp<uint64_t>(pages_for(capacity), 1, most));
    SurfelPool pool;
    LUCARNE_ASSIGN(pool.buffer_,
                   device.texels(size_t{pages} * kPageSurfels * sizeof(PackedSurfel), "surfel pool"));
    pool.capacity_ = pages * kPageSurfels;
    pool.evict_all();
    return pool;
}

Result<bool> SurfelPool::load(uint32_t node, std::span<const PackedSurfel> surfels) {
    evict(node);
    const uint32_t pages = pages_for(surfels.size());
    if (pages > free_.size()) return false;
    // Reversed, so that pages are used in ascending order: freed nodes return their pages in order, and runs
    // of pages are uploaded at once.
    PlacedNode resident{
        {free_.end() - pages, free_.end()}, static_cast<uint32_t>(surfels.size()), content_of(surfels)};
    std::reverse(resident.pages.begin(), resident.pages.end());
    free_.resize(free_.size() - pages);
    upload(resident, surfels);
    resident_[node] = std::move(resident);
    return true;
}

void SurfelPool::upload(const PlacedNode& node, std::span<const PackedSurfel> surfels) {
    assert(node.pages.size() == pages_for(surfels.size()));
    for (size_t page = 0; page < node.pages.size();) {
        size_t end = page + 1;
        while (end < node.pages.size() && node.pages[end] == node.pages[end - 1] + 1) ++end;
        const size_t first = page * kPageSurfels, last = std::min(end * kPageSurfels, surfels.size());
        buffer_.upload(size_t{node.pages[page]} * kPageSurfels * sizeof(PackedSurfel),
                       std::as_bytes(surfels.subspan(first, last - first)));
        page = end;
    }
}

void SurfelPool::evict(uint32_t node) {
    const auto found = resident_.find(node);
    if (found == resident_.end()) return;
    const std::vector<uint32_t>& pages = found->second.pages;
    free_.insert(free_.end(), pages.rbegin(), pages.rend());
    assert(free_.size() <= capacity_ / kPageSurfels);
    resident_.erase(found);
}

void SurfelPool::evict_all() {
    resident_.clear();
    free_.clear();
    for (uint32_t page = capacity_ / kPageSurfels; page-- > 0;) free_.push_back(page);
}

bool SurfelPool::holds(uint32_t node) const {
    return resident_.contains(node);
}
uint32_t SurfelPool::used() const {
    return capacity_ - static_cast<uint32_t>(free_.size()) * kPageSurfels;
}
uint32_t SurfelPool::capacity() const {
    return capacity_;
}

Result<void> SurfelPool::make_cut(Device& device, const octree::NodeSource& source,
                                  std::span<const CutEntry> entries, const glm::dvec3& local_origin,
                                  DeviceCut& cut, const Clip& clip,
                                  std::span<const octree::Filling> fillings) const {
    CutParts parts = cut_parts(source, entries, local_origin, resident_, clip, fillings);
    assert(parts.surfels <= capacity_);
    const size_t item_bytes = parts.items.size() * sizeof(CutItem);
    const size_t clip_bytes = parts.clip.shapes.size() * sizeof(ClipShape);
    LUCARNE_TRY(device.reserve(cut.items_, item_bytes + clip_bytes, "cut"));
    LUCARNE_TRY(device.reserve(cut.blocks_buffer_, parts.blocks.size() * sizeof(CutBlock), "cut"));
    cut.items_.upload_all(parts.items);
    cut.items_.upload(item_bytes, std::as_bytes(std::span(parts.clip.shapes)));
    cut.blocks_buffer_.upload_all(parts.blocks);
    cut.pool_ = &buffer_;
    cut.points_ = std::make_shared<CutPoints>(std::exchange(parts.runs, {}));
    cut.parts_ = std::move(parts);
    cut.on_host_.reset();
    return {};
}

std::vector<Surfel> SurfelPool::download(const DeviceCut& cut) const {
    std::vector<Surfel> surfels;
    surfels.reserve(cut.surfels());
    each_surfel(cut, [&](uint32_t, const Surfel& surfel) { surfels.push_back(surfel); });
    return surfels;
}

void SurfelPool::each_surfel(const DeviceCut& cut,
                             const std::function<void(uint32_t, const Surfel&)>& visit) const {
    std::vector<PackedSurfel> packed;
    const std::span<const CutBlock> blocks = cut.parts_.blocks;
    for (size_t next = 0; next < blocks.size();) {
        // Each call waits for the device, so one takes all blocks that lie one behind the other.
        const uint32_t first = blocks[next].first;
        uint32_t count = 0;
        size_t end = next;
        while (end < blocks.size() && blocks[end].first == first + count && count < kMostDownloaded)
            count += blocks[end++].count;
        packed.resize(count);
        buffer_.download(size_t{first} * sizeof(PackedSurfel), std::as_writable_bytes(std::span(packed)));
        for (size_t at = 0; next < end; at += blocks[next++].count) {
            const CutItem& item = cut.parts_.items[blocks[next].item];
            for (uint32_t i = 0; i < blocks[next].count; ++i) {
                const Surfel surfel = unpack(cut.parts_.items, item, packed[at + i]);
                if (item.clip && !cut.parts_.clip.keeps(surfel.position)) continue;
                visit(static_cast<uint32_t>(next * kBlockSurfels) + i, surfel);
            }
        }
    }
}

}  // namespace lucarne::gi
