#include "gi/surfels/cut_parts.h"

#include <algorithm>
#include <cmath>

#include <xxhash.h>

#include "gi/shared/edge.h"
#include "gi/shared/surfel_code.h"
#include "gi/surfels/area_floor.h"
#include "io/core/random.h"
#include "octree/tree/footprint.h"

namespace lucarne::gi {

static_assert(kPageSurfels % kBlockSurfels == 0, "no block lies across two pages");

namespace {

constexpr uint64_t kPointsOfFilled = 4;  // for each synthetic surfel a cut has at least so many points

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

/// Adds synthetic surfels: cubes whose surfels all have shares of their own and no levels of detail. They
/// come after all points, and no run of CutPoints has their ids.
void add_filling(const octree::Filling& filling, uint32_t first, double unit, const glm::dvec3& local_origin,
                 const PlacedNodes& placed, const Clip& clip, CutParts& parts) {
    for (uint32_t i = 0; i < filling.nodes.size(); ++i) {
        const auto found = placed.find(first + i);
        if (found == placed.end()) continue;
        const octree::Cube own = filling.header.root.of(filling.nodes[i].key);
        const octree::Cube cube{own.min * filling.scale, own.size * filling.scale};
        CutItem item{};
        item.origin = glm::vec3((cube.min - local_origin) * unit);
        item.size = static_cast<float>(cube.size * unit);
        item.count = found->second.count;
        for (int& child : item.child) child = kCoarseOctant;
        const Kept seen = clip.active() ? kept(clip, cube) : Kept::all;
        item.clip = seen == Kept::some;  // its index is set by cut_parts()
        const uint32_t drawn = seen == Kept::none ? 0 : item.count;
        const double mean = filling.nodes[i].area_floor[0] * filling.scale * filling.scale * unit * unit;
        const auto whole = static_cast<float>(std::min(mean * item.count, double{item.size * item.size}));
        for (uint32_t at = 0; at < drawn; at += kBlockSurfels) {
            const uint32_t count = std::min(drawn - at, kBlockSurfels);
            const auto lod = [&](uint32_t points) {
                return area_code(std::max(whole / static_cast<float>(std::max(points, 1u)), 1e-18f));
            };
            parts.blocks.push_back({static_cast<uint32_t>(parts.items.size()),
                                    found->second.pages[at / kPageSurfels] * kPageSurfels + at % kPageSurfels,
                                    count, lod(at) | lod(at + count) << 16});
        }
        parts.fingerprint = mix64(parts.fingerprint, found->second.content);
        if (drawn)
            parts.nodes.push_back(
                {first + i, mix64(found->second.content, hash(std::span<const CutItem>(&item, 1)))});
        parts.items.push_back(item);
    }
}

}  // namespace

uint64_t content_of(std::span<const PackedSurfel> surfels) {
    return hash(surfels);
}

std::span<const octree::Filling> fillings_of(std::span<const octree::Filling> all, uint64_t points) {
    uint64_t filled = 0;
    for (const octree::Filling& filling : all)
        for (const octree::NodeInfo& node : filling.nodes) filled += node.count;
    return kPointsOfFilled * filled > points ? all.first(0) : all;
}

CutParts cut_parts(const octree::NodeSource& source, std::span<const CutEntry> entries,
                   const glm::dvec3& local_origin, const PlacedNodes& placed, const Clip& clip,
                   std::span<const octree::Filling> fillings) {
    const auto nodes = source.nodes();
    const double unit = source.header().metres_per_unit;
    std::vector<CutEntry> sorted(entries.begin(), entries.end());
    std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.node < b.node; });
    std::unordered_map<uint32_t, uint32_t> item_of;  // node -> item; parents come before their children
    CutParts parts;
    auto& [items, blocks, cut_nodes, runs, device_clip, fingerprint, surfels, clipped, size] = parts;
    for (const CutEntry& entry : sorted) {
        const auto found = placed.find(entry.node);
        if (entry.node >= nodes.size() || found == placed.end() || item_of.contains(entry.node)) continue;
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
        fingerprint = mix64(fingerprint, found->second.content);
        item.count = std::min(entry.count, found->second.count);
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
        if (drawn) runs.push_back({static_cast<uint32_t>(blocks.size()), entry.node, drawn});
        for (uint32_t at = 0; at < drawn; at += kBlockSurfels) {
            const uint32_t count = std::min(drawn - at, kBlockSurfels);
            const uint32_t first = found->second.pages[at / kPageSurfels] * kPageSurfels + at % kPageSurfels;
            blocks.push_back({index, first, count, lod(at) | lod(at + count) << 16});
        }
        // Which items the children are differs from cut to cut; whether there are any shows in the areas.
        CutItem own = item;
        for (int& child : own.child) child = std::min(child, 0);
        if (drawn)
            cut_nodes.push_back(
                {entry.node, mix64(found->second.content, hash(std::span<const CutItem>(&own, 1)))});
        surfels += drawn;
        clipped += item.count - drawn;
        items.push_back(item);
    }
    uint32_t first_filled = kFirstFilled;
    for (const octree::Filling& filling : fillings) {
        add_filling(filling, first_filled, unit, local_origin, placed, clip, parts);
        first_filled += static_cast<uint32_t>(filling.nodes.size());
    }
    device_clip = gi::device_clip(clip, local_origin, unit);
    for (CutItem& item : items)
        if (item.clip) item.clip = static_cast<uint32_t>(items.size());
    fingerprint = mix64(fingerprint, hash(std::span<const CutItem>(items)));
    fingerprint = mix64(fingerprint, hash(std::span<const ClipShape>(device_clip.shapes)));
    size = static_cast<float>(source.header().root.size * unit);
    return parts;
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
    if (packed.d & kSurfelHasEdge)
        surfel.edge = edge_of_code(surfel_edge_code(packed.c, packed.d), surfel.normal, std::sqrt(own));
    return surfel;
}

}  // namespace lucarne::gi
