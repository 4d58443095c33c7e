// What a cut consists of, on the host: the half of making one that needs no device.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/scene/clip.h"
#include "gi/shared/surfel.h"
#include "gi/surfels/cut_nodes.h"
#include "octree/tree/source.h"

namespace lucarne::gi {

/// No node holds more surface than this many faces of its cube; a file that claims more is not a scan.
inline constexpr double kMostSurface = 64;

/// Packed surfels are stored in pages of this many.
inline constexpr uint32_t kPageSurfels = 1024;
constexpr uint32_t pages_for(size_t surfels) {
    return static_cast<uint32_t>((surfels + kPageSurfels - 1) / kPageSurfels);
}

/// The number of the first node of the fillings (octree::Filling); those of a source's nodes are smaller.
inline constexpr uint32_t kFirstFilled = 0x80000000u;

/// A node of a cut and how many of its points are drawn.
struct CutEntry {
    uint32_t node = 0;
    uint32_t count = 0;  ///< length of the prefix in use
};

/// Where the packed surfels of a node are.
struct PlacedNode {
    std::vector<uint32_t> pages;
    uint32_t count = 0;    ///< surfels
    uint64_t content = 0;  ///< content_of() them
};
using PlacedNodes = std::unordered_map<uint32_t, PlacedNode>;

/// Returns a hash of packed surfels.
uint64_t content_of(std::span<const PackedSurfel> surfels);

/// A cut as shaders and the host read it.
struct CutParts {
    /// The blocks from `first_block` on show the first `count` points of `node`.
    struct Run {
        uint32_t first_block, node, count;
    };
    std::vector<CutItem> items;
    std::vector<CutBlock> blocks;
    std::vector<CutNode> nodes;  ///< those that are drawn, sorted
    std::vector<Run> runs;       ///< by first_block; synthetic surfels are in none
    DeviceClip clip;
    /// Hash of what the cut shows: equal for equal surfels at equal places.
    uint64_t fingerprint = 0;
    uint64_t surfels = 0, clipped = 0;  ///< points drawn; points of nodes that are clipped as a whole
    float size = 1;                     ///< m, side of the source's root cube
};

/// Builds a cut of placed nodes. `entries` must contain the ancestors of every entry; entries that are not
/// placed are left out with their descendants. `local_origin` is in world units; the cut is in metres
/// relative to it. Surfels that `clip` removes do not exist for readers of the cut. `fillings` are drawn
/// whole as far as they are placed: their nodes, one after the other, as kFirstFilled and the following
/// numbers.
CutParts cut_parts(const octree::NodeSource& source, std::span<const CutEntry> entries,
                   const glm::dvec3& local_origin, const PlacedNodes& placed, const Clip& clip = {},
                   std::span<const octree::Filling> fillings = {});

/// Returns those fillings that a cut of so many points draws: all or none. A cut of few points, as a cap asks
/// for, stays small: synthetic surfels have no levels of detail.
std::span<const octree::Filling> fillings_of(std::span<const octree::Filling> all, uint64_t points);

/// Decodes a packed surfel of an item with its footprint.
Surfel unpack(std::span<const CutItem> items, const CutItem& item, const PackedSurfel& packed);

}  // namespace lucarne::gi
