#include "gi/scene/surfel_pool.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <xxhash.h>

#include "gi/shared/surfel_code.h"
#include "io/core/random.h"
#include "octree/footprint.h"

namespace lucarne::gi {
namespace {

constexpr uint32_t pages_for(size_t surfels) {
    return static_cast<uint32_t>((surfels + SurfelPool::kPageSurfels - 1) / SurfelPool::kPageSurfels);
}

/// m^2. The shares in a node add up to its surface, and no node holds more than a few times the surface of
/// its cube: a hostile cache's floors must not make discs that cover the world.
float sane_floor(const octree::NodeInfo& info, uint32_t count, double metres_per_unit, float size) {
    const float share = info.count ? static_cast<float>(count) / static_cast<float>(info.count) : 1.0f;
    const float floors[4] = {info.area_floor[0], info.area_floor[1], info.area_floor[2], info.area_floor[3]};
    const double floor = octree::floor_at_prefix(floors, share) * metres_per_unit * metres_per_unit;
    const double most = kMostSurface * size * size / std::max(count, 1u);
    return floor > 0 ? static_cast<float>(std::min(floor, most)) : 0.0f;  // NaN: 0
}

/// m^2: what a point stands for when the first `points` of a node are drawn and nothing below it. At least
/// what an even pattern would have: where the raw scan fills the surface by its own shares, the floor is
/// nothing.
float stage_area(const octree::NodeInfo& info, double points, double metres_per_unit, const CutItem& item,
                 float above) {
    if (points < 1 || info.count == 0) return above;
    const double share = std::min(points / info.count, 1.0);
    const double even =
        share > 0.5 ? info.area_floor[1] * 0.5 / share * metres_per_unit * metres_per_unit : 0.0;
    const float floor = sane_floor(info, static_cast<uint32_t>(points), metres_per_unit, item.size);
    return std::min(above, std::max(floor, even > 0 ? static_cast<float>(even) : 0.0f));
}

uint32_t area_code(float area) {
    return static_cast<uint32_t>(std::clamp((std::log2(area) + 64) * 512 + 0.5f, 0.0f, 65535.0f));
}

template <class T>
uint64_t hash(std::span<const T> values) {
    return XXH3_64bits(values.data(), values.size_bytes());
}

/// The same walk as gi/shared/cut.glsl's.
float local_floor(const std::vector<CutItem>& items, const CutItem* item, const PackedSurfel& surfel) {
    for (uint32_t depth = 0; depth < kOctantLevels; ++depth) {
        const int child = item->child[surfel_octant(surfel.a, surfel.b, depth)];
        if (child == kWholeOctant) return 0.0f;
        if (child < 0) break;
        item = &items[static_cast<size_t>(child)];
    }
    return item->area_floor;
}

Surfel unpack(const std::vector<CutItem>& items, const CutItem& item, const PackedSurfel& packed) {
    const float own = surfel_own_area(packed.b, item.size);
    const float floor = local_floor(items, &item, packed);
    Surfel surfel;
    surfel.position = item.origin + item.size * surfel_fractions(packed.a, packed.b);
    surfel.normal = packed.d & kSurfelHasNormal ? decode_octahedral(packed.c) : glm::vec3(0.0f);
    surfel.albedo = decode_albedo(packed.d);
    const bool stray = surfel_is_stray(packed.b, packed.d);
    surfel.radius = stray ? 0.0f : octree::surfel_radius(own, floor);
    surfel.area = stray ? 0.0f : octree::surfel_area(own, floor);
    surfel.material = surfel_material(packed.b);
    return surfel;
}

}  // namespace

void DeviceCut::bind() const {
    pool_->bind_texels(0, TexelView::four_words);
    items_.bind_texels(1, TexelView::four_words);
    blocks_buffer_.bind_texels(2, TexelView::four_words);
}

Result<SurfelPool> SurfelPool::create(Device& device, uint32_t capacity) {
    const uint64_t most = uint64_t{UINT32_MAX} / kPageSurfels;
    const auto pages = static_cast<uint32_t>(std::clamp<uint64_t>(pages_for(capacity), 1, most));
    SurfelPool pool;
    LUCARNE_ASSIGN(pool.buffer_,
                   device.texels(size_t{pages} * kPageSurfels * sizeof(PackedSurfel), "surfel pool"));
    pool.capacity_ = pages * kPageSurfels;
    pool.free_ = {{0, pages}};
    return pool;
}

Result<bool> SurfelPool::load(uint32_t node, std::span<const PackedSurfel> surfels) {
    evict(node);
    const uint32_t pages = pages_for(surfels.size());
    if (pages == 0) {
        resident_[node] = {0, 0};
        return true;
    }
    if (pages > capacity_ / kPageSurfels - used_pages_) return false;
    const auto large_enough = [&](const Span& s) { return s.count >= pages; };
    auto fits = std::find_if(free_.begin(), free_.end(), large_enough);
    if (fits == free_.end()) {
        compact();
        fits = free_.begin();
    }
    const uint32_t first = fits->first * kPageSurfels;
    fits->first += pages;
    fits->count -= pages;
    if (fits->count == 0) free_.erase(fits);
    used_pages_ += pages;
    resident_[node] = {first, static_cast<uint32_t>(surfels.size()), hash(surfels)};
    buffer_.upload(size_t{first} * sizeof(PackedSurfel), std::as_bytes(surfels));
    return true;
}

void SurfelPool::evict(uint32_t node) {
    const auto found = resident_.find(node);
    if (found == resident_.end()) return;
    const Span surfels = found->second;
    resident_.erase(found);
    if (surfels.count) release({surfels.first / kPageSurfels, pages_for(surfels.count)});
}

void SurfelPool::release(Span pages) {
    used_pages_ -= pages.count;
    const auto after = std::lower_bound(free_.begin(), free_.end(), pages,
                                        [](const Span& a, const Span& b) { return a.first < b.first; });
    auto here = free_.insert(after, pages);
    if (const auto next = here + 1; next != free_.end() && here->first + here->count == next->first) {
        here->count += next->count;
        free_.erase(next);
    }
    if (here == free_.begin()) return;
    if (const auto before = here - 1; before->first + before->count == here->first) {
        before->count += here->count;
        free_.erase(here);
    }
}

/// Moves all nodes to the beginning, in the order in which they lie, so that what is free is one span.
void SurfelPool::compact() {
    std::vector<Span*> spans;
    for (auto& [node, span] : resident_)
        if (span.count) spans.push_back(&span);
    std::sort(spans.begin(), spans.end(), [](const Span* a, const Span* b) { return a->first < b->first; });
    uint32_t page = 0;
    for (Span* span : spans) {
        const uint32_t first = page * kPageSurfels;
        buffer_.move_down(size_t{span->first} * sizeof(PackedSurfel), size_t{first} * sizeof(PackedSurfel),
                          size_t{span->count} * sizeof(PackedSurfel));
        span->first = first;
        page += pages_for(span->count);
    }
    free_ = {{page, capacity_ / kPageSurfels - page}};
}

bool SurfelPool::holds(uint32_t node) const {
    return resident_.contains(node);
}
uint32_t SurfelPool::used() const {
    return used_pages_ * kPageSurfels;
}
uint32_t SurfelPool::capacity() const {
    return capacity_;
}

Result<void> SurfelPool::make_cut(Device& device, const octree::NodeSource& source,
                                  std::span<const CutEntry> entries, const glm::dvec3& local_origin,
                                  DeviceCut& cut) const {
    const auto nodes = source.nodes();
    const double unit = source.header().metres_per_unit;
    const bool areas_known = source.header().schema.find(io::names::area) != nullptr;
    std::vector<CutEntry> sorted(entries.begin(), entries.end());
    std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.node < b.node; });
    std::unordered_map<uint32_t, uint32_t> item_of;  // node -> item; parents stand before their children
    std::vector<CutItem> items;
    std::vector<CutBlock> blocks;
    uint64_t surfels = 0;
    cut.fingerprint_ = 0;
    for (const CutEntry& entry : sorted) {
        const auto resident = resident_.find(entry.node);
        if (entry.node >= nodes.size() || resident == resident_.end() || item_of.contains(entry.node))
            continue;
        const octree::NodeInfo& info = nodes[entry.node];
        const auto parent = item_of.find(info.parent);
        if (info.parent != octree::kNoNode && parent == item_of.end()) continue;
        const auto index = static_cast<uint32_t>(items.size());
        if (parent != item_of.end()) {
            items[parent->second].child[info.key.octant()] = static_cast<int>(index);
            items[parent->second].inner = 1;
        }
        item_of.emplace(entry.node, index);
        const octree::Cube cube = source.header().root.of(info.key);
        CutItem item{};
        item.origin = glm::vec3((cube.min - local_origin) * unit);
        item.size = static_cast<float>(cube.size * unit);
        item.first = resident->second.first;
        cut.fingerprint_ = mix64(cut.fingerprint_, resident->second.content);
        item.count = std::min(entry.count, resident->second.count);
        // A few points of a node among many of its ancestors' leave those as large as they were, and no
        // larger.
        const float above =
            parent != item_of.end() ? items[parent->second].area_floor : item.size * item.size;
        item.area_floor = std::min(sane_floor(info, item.count, unit, item.size), above);
        const bool whole = areas_known && item.count == info.count && info.child_mask != 0;
        for (uint32_t octant = 0; octant < 8; ++octant)
            item.child[octant] = whole && !(info.child_mask >> octant & 1) ? kWholeOctant : kCoarseOctant;
        item.inner = whole && info.child_mask != 0xff;
        const auto lod = [&](uint32_t points) {
            return area_code(stage_area(info, points, unit, item, above));
        };
        for (uint32_t at = 0; at < item.count; at += kBlockSurfels) {
            const uint32_t count = std::min(item.count - at, kBlockSurfels);
            blocks.push_back({index, item.first + at, count, lod(at) | lod(at + count) << 16});
        }
        surfels += item.count;
        items.push_back(item);
    }
    LUCARNE_TRY(device.reserve(cut.items_, items.size() * sizeof(CutItem), "cut"));
    LUCARNE_TRY(device.reserve(cut.blocks_buffer_, blocks.size() * sizeof(CutBlock), "cut"));
    cut.fingerprint_ = mix64(cut.fingerprint_, hash(std::span<const CutItem>(items)));
    cut.items_.upload_all(items);
    cut.blocks_buffer_.upload_all(blocks);
    cut.pool_ = &buffer_;
    cut.host_items_ = std::move(items);
    cut.surfels_ = static_cast<uint32_t>(surfels);  // at most the pool's capacity
    cut.blocks_ = static_cast<uint32_t>(blocks.size());
    return {};
}

std::vector<Surfel> SurfelPool::download(const DeviceCut& cut) const {
    std::vector<Surfel> surfels;
    surfels.reserve(cut.surfels());
    std::vector<PackedSurfel> packed;
    for (const CutItem& item : cut.host_items_) {
        packed.resize(item.count);
        buffer_.download(size_t{item.first} * sizeof(PackedSurfel),
                         std::as_writable_bytes(std::span(packed)));
        for (const PackedSurfel& one : packed) surfels.push_back(unpack(cut.host_items_, item, one));
    }
    return surfels;
}

}  // namespace lucarne::gi
