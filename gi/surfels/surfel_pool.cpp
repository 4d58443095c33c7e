#include "gi/surfels/surfel_pool.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <span>

#include <xxhash.h>

#include "gi/shared/cut_bindings.h"
#include "gi/shared/surfel_code.h"
#include "gi/surfels/area_floor.h"
#include "io/core/random.h"
#include "octree/tree/footprint.h"

namespace lucarne::gi {

static_assert(SurfelPool::kPageSurfels % kBlockSurfels == 0, "no block lies across two pages");

namespace {

constexpr uint32_t pages_for(size_t surfels) {
    return static_cast<uint32_t>((surfels + SurfelPool::kPageSurfels - 1) / SurfelPool::kPageSurfels);
}

/// Returns the area floor of a node, m^2, bounded from above. The shares in a node add up to its surface,
/// and no node holds more than a few times the surface of its cube, so the floors of a hostile cache cannot
/// make discs that cover the world.
float sane_floor(const octree::NodeInfo& info, uint32_t count, double metres_per_unit, float size) {
    const float share = info.count ? static_cast<float>(count) / static_cast<float>(info.count) : 1.0f;
    const float floors[4] = {info.area_floor[0], info.area_floor[1], info.area_floor[2], info.area_floor[3]};
    const double floor = octree::floor_at_prefix(floors, share) * metres_per_unit * metres_per_unit;
    const double most = kMostSurface * size * size / std::max(count, 1u);
    return floor > 0 ? static_cast<float>(std::min(floor, most)) : 0.0f;  // NaN: 0
}

/// Returns the area, m^2, that a point stands for when the first `points` of a node are drawn and nothing
/// below it. It is at least the area of an even pattern: where the raw scan fills the surface by its own
/// shares, the floor is 0.
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

Surfel unpack(std::span<const CutItem> items, const CutItem& item, const PackedSurfel& packed) {
    const float own = surfel_own_area(packed.b, item.size);
    const float floor = local_floor(items, item, packed.a, packed.b);
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

std::optional<PointPlace> CutPoints::find(uint32_t id) const {
    const uint32_t block = id / kBlockSurfels;
    const auto after = std::ranges::upper_bound(runs_, block, {}, &Run::first_block);
    if (after == runs_.begin()) return std::nullopt;
    const Run& run = *(after - 1);
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
    for (uint32_t page = pages; page-- > 0;) pool.free_.push_back(page);
    return pool;
}

Result<bool> SurfelPool::load(uint32_t node, std::span<const PackedSurfel> surfels) {
    evict(node);
    const uint32_t pages = pages_for(surfels.size());
    if (pages > free_.size()) return false;
    // Reversed, so that pages are used in ascending order: freed nodes return their pages in order, and runs
    // of pages are uploaded at once.
    Resident resident{
        {free_.end() - pages, free_.end()}, static_cast<uint32_t>(surfels.size()), hash(surfels)};
    std::reverse(resident.pages.begin(), resident.pages.end());
    free_.resize(free_.size() - pages);
    upload(resident, surfels);
    resident_[node] = std::move(resident);
    return true;
}

void SurfelPool::upload(const Resident& node, std::span<const PackedSurfel> surfels) {
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

bool SurfelPool::holds(uint32_t node) const {
    return resident_.contains(node);
}
uint32_t SurfelPool::used() const {
    return capacity_ - static_cast<uint32_t>(free_.size()) * kPageSurfels;
}
uint32_t SurfelPool::capacity() const {
    return capacity_;
}

/// What a cut consists of, on the host.
struct SurfelPool::CutParts {
    std::vector<CutItem> items;
    std::vector<CutBlock> blocks;
    std::vector<CutNode> nodes;
    uint64_t fingerprint = 0, surfels = 0, clipped = 0;
};

/// Adds synthetic surfels: cubes whose surfels all have shares of their own and no levels of detail. They
/// come after all points, and no run of CutPoints has their ids.
void SurfelPool::add_filling(const octree::Filling& filling, uint32_t first, double unit,
                             const glm::dvec3& local_origin, const Clip& clip, CutParts& parts) const {
    for (uint32_t i = 0; i < filling.nodes.size(); ++i) {
        const auto resident = resident_.find(first + i);
        if (resident == resident_.end()) continue;
        const octree::Cube own = filling.header.root.of(filling.nodes[i].key);
        const octree::Cube cube{own.min * filling.scale, own.size * filling.scale};
        CutItem item{};
        item.origin = glm::vec3((cube.min - local_origin) * unit);
        item.size = static_cast<float>(cube.size * unit);
        item.count = resident->second.count;
        for (int& child : item.child) child = kCoarseOctant;
        const Kept seen = clip.active() ? kept(clip, cube) : Kept::all;
        item.clip = seen == Kept::some;  // its index is set by make_cut
        const uint32_t drawn = seen == Kept::none ? 0 : item.count;
        const double mean = filling.nodes[i].area_floor[0] * filling.scale * filling.scale * unit * unit;
        const auto whole = static_cast<float>(std::min(mean * item.count, double{item.size * item.size}));
        for (uint32_t at = 0; at < drawn; at += kBlockSurfels) {
            const uint32_t count = std::min(drawn - at, kBlockSurfels);
            const auto lod = [&](uint32_t points) {
                return area_code(std::max(whole / static_cast<float>(std::max(points, 1u)), 1e-18f));
            };
            parts.blocks.push_back(
                {static_cast<uint32_t>(parts.items.size()),
                 resident->second.pages[at / kPageSurfels] * kPageSurfels + at % kPageSurfels, count,
                 lod(at) | lod(at + count) << 16});
        }
        parts.fingerprint = mix64(parts.fingerprint, resident->second.content);
        if (drawn)
            parts.nodes.push_back(
                {first + i, mix64(resident->second.content, hash(std::span<const CutItem>(&item, 1)))});
        parts.items.push_back(item);
    }
}

Result<void> SurfelPool::make_cut(Device& device, const octree::NodeSource& source,
                                  std::span<const CutEntry> entries, const glm::dvec3& local_origin,
                                  DeviceCut& cut, const Clip& clip,
                                  std::span<const octree::Filling> fillings) const {
    const auto nodes = source.nodes();
    const double unit = source.header().metres_per_unit;
    std::vector<CutEntry> sorted(entries.begin(), entries.end());
    std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.node < b.node; });
    std::unordered_map<uint32_t, uint32_t> item_of;  // node -> item; parents come before their children
    CutParts parts;
    auto& [items, blocks, cut_nodes, fingerprint, surfels, clipped] = parts;
    const auto cut_points = std::make_shared<CutPoints>();
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
        const octree::Cube cube = source.cube(entry.node);
        const bool areas_known = source.part_of(entry.node).header.schema.find(io::names::area) != nullptr;
        CutItem item{};
        item.origin = glm::vec3((cube.min - local_origin) * unit);
        item.size = static_cast<float>(cube.size * unit);
        fingerprint = mix64(fingerprint, resident->second.content);
        item.count = std::min(entry.count, resident->second.count);
        // The floor never exceeds the parent's: where few points of a node stand among many of its
        // ancestors, the ancestors' points must not grow.
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
        const Kept seen = clip.active() ? kept(clip, cube) : Kept::all;
        item.clip = seen == Kept::some;  // its index is set below
        const uint32_t drawn = seen == Kept::none ? 0 : item.count;
        if (drawn) cut_points->runs_.push_back({static_cast<uint32_t>(blocks.size()), entry.node, drawn});
        for (uint32_t at = 0; at < drawn; at += kBlockSurfels) {
            const uint32_t count = std::min(drawn - at, kBlockSurfels);
            const uint32_t first =
                resident->second.pages[at / kPageSurfels] * kPageSurfels + at % kPageSurfels;
            blocks.push_back({index, first, count, lod(at) | lod(at + count) << 16});
        }
        // Which items the children are differs from cut to cut; whether there are any shows in the areas.
        CutItem own = item;
        for (int& child : own.child) child = std::min(child, 0);
        if (drawn)
            cut_nodes.push_back(
                {entry.node, mix64(resident->second.content, hash(std::span<const CutItem>(&own, 1)))});
        surfels += drawn;
        clipped += item.count - drawn;
        items.push_back(item);
    }
    uint32_t first_filled = kFirstFilled;
    for (const octree::Filling& filling : fillings) {
        add_filling(filling, first_filled, unit, local_origin, clip, parts);
        first_filled += static_cast<uint32_t>(filling.nodes.size());
    }
    assert(surfels <= capacity_);
    cut.clip_ = device_clip(clip, local_origin, unit);
    for (CutItem& item : items)
        if (item.clip) item.clip = static_cast<uint32_t>(items.size());
    const size_t item_bytes = items.size() * sizeof(CutItem);
    LUCARNE_TRY(device.reserve(cut.items_, item_bytes + cut.clip_.shapes.size() * sizeof(ClipShape), "cut"));
    LUCARNE_TRY(device.reserve(cut.blocks_buffer_, blocks.size() * sizeof(CutBlock), "cut"));
    cut.fingerprint_ = mix64(fingerprint, hash(std::span<const CutItem>(items)));
    cut.fingerprint_ = mix64(cut.fingerprint_, hash(std::span<const ClipShape>(cut.clip_.shapes)));
    cut.items_.upload_all(items);
    cut.items_.upload(item_bytes, std::as_bytes(std::span(cut.clip_.shapes)));
    cut.blocks_buffer_.upload_all(blocks);
    cut.pool_ = &buffer_;
    cut.nodes_ = std::move(cut_nodes);
    cut.host_items_ = std::move(items);
    cut.clipped_ = static_cast<uint32_t>(clipped);
    cut.surfels_ = static_cast<uint32_t>(surfels);
    cut.blocks_ = static_cast<uint32_t>(blocks.size());
    cut.host_blocks_ = std::move(blocks);
    cut.points_ = cut_points;
    cut.on_host_.reset();
    cut.size_ = static_cast<float>(source.header().root.size * unit);
    return {};
}

std::vector<Surfel> SurfelPool::download(const DeviceCut& cut) const {
    std::vector<Surfel> surfels;
    surfels.reserve(cut.surfels());
    std::array<PackedSurfel, kBlockSurfels> packed;
    for (const CutBlock& block : cut.host_blocks_) {
        buffer_.download(size_t{block.first} * sizeof(PackedSurfel),
                         std::as_writable_bytes(std::span(packed).first(block.count)));
        const CutItem& item = cut.host_items_[block.item];
        for (uint32_t i = 0; i < block.count; ++i) {
            const Surfel surfel = unpack(cut.host_items_, item, packed[i]);
            if (!item.clip || cut.clip_.keeps(surfel.position)) surfels.push_back(surfel);
        }
    }
    return surfels;
}

}  // namespace lucarne::gi
