#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/device/gl/device.h"
#include "gi/scene/scene.h"
#include "gi/shared/surfel.h"
#include "gi/surfels/cut_nodes.h"
#include "octree/tree/source.h"

namespace lucarne::gi {

/// No node holds more surface than this many faces of its cube; what claims more is no scan.
inline constexpr double kMostSurface = 64;

class BakedLight;

/// Packs a node's points for the device: positions as fractions of the node's cube, colours to 10-bit sRGB
/// (.5 linear where the scan has none), normals from `normal` or `normal_oct`, areas from `area`. The
/// material is the last one in the scene whose conditions all hold ([0], the default, has none); those beyond
/// 256 are not used. Colours are what the scene's look asks for (`first_scan` counts the records' scans from
/// there); points of hidden classes become strays. `baked` is divided out of the points' own colours, as far
/// as the scene's albedo asks.
std::vector<PackedSurfel> pack_surfels(const octree::SourceHeader& header, const octree::NodeInfo& node,
                                       const octree::NodeData& data, const Scene& scene,
                                       uint32_t first_scan = 0, const BakedLight* baked = nullptr);

/// One node of a cut as the stream chose it.
struct CutEntry {
    uint32_t node = 0;
    uint32_t count = 0;  ///< prefix
};

/// A point of a source: the record `index` of what NodeSource::load gives for `node`.
struct PointPlace {
    uint32_t node = 0, index = 0;
    bool operator==(const PointPlace&) const = default;
};

/// Which points the surfels of a cut are; outlives the cut.
class CutPoints {
 public:
    /// The point behind an id of a G-buffer drawn of the cut; none for kNoSurfel and ids of no surfel.
    std::optional<PointPlace> find(uint32_t id) const;

 private:
    friend class SurfelPool;
    struct Run {
        uint32_t first_block, node, count;
    };
    std::vector<Run> runs_;  ///< by first_block
};

/// A cut on the device, made by SurfelPool::make_cut; valid until a node of it is evicted or the pool goes.
/// Bindings are fixed for every shader: see bind().
class DeviceCut {
 public:
    uint32_t surfels() const { return surfels_; }  ///< points drawn, with those that are tested and clipped
    uint32_t clipped() const { return clipped_; }  ///< points of nodes that are clipped whole
    uint32_t blocks() const { return blocks_; }    ///< workgroups of kBlockSurfels to dispatch
    float size() const { return size_; }           ///< m, side of the source's root cube
    /// Of what the cut shows: equal for equal surfels at equal places.
    uint64_t fingerprint() const { return fingerprint_; }
    /// The nodes that are drawn, sorted.
    std::span<const CutNode> nodes() const { return nodes_; }
    std::shared_ptr<const CutPoints> points() const { return points_; }
    /// Binds pool, items and blocks as texels at the units 0 to 2. gi/shared/cut.glsl declares them.
    void bind() const;

 private:
    friend class SurfelPool;
    const Buffer* pool_ = nullptr;
    Buffer items_, blocks_buffer_;
    std::vector<CutItem> host_items_;
    std::vector<CutBlock> host_blocks_;
    DeviceClip clip_;
    uint32_t surfels_ = 0, blocks_ = 0, clipped_ = 0;
    float size_ = 1;
    uint64_t fingerprint_ = 0;
    std::vector<CutNode> nodes_;
    std::shared_ptr<const CutPoints> points_;
};

/// Owns the surfels of all resident nodes in one buffer cut into pages of kPageSurfels, fed by the stream's
/// load, replace and evict events. A node takes any pages, so that free ones are never too scattered.
class SurfelPool {
 public:
    static constexpr uint32_t kPageSurfels = 1024;
    /// `capacity` surfels (rounded to pages), 16 bytes each, all taken at once so that the cap is hard.
    static Result<SurfelPool> create(Device& device, uint32_t capacity);

    /// False when there is no room: the caller evicts and tries again. A node that is resident is replaced.
    Result<bool> load(uint32_t node, std::span<const PackedSurfel> surfels);
    void evict(uint32_t node);
    bool holds(uint32_t node) const;
    uint32_t used() const;  ///< surfels' worth of pages in use
    uint32_t capacity() const;

    /// Builds a cut from resident nodes (entries must be ancestor-closed; those that are not resident are
    /// left out with their descendants). `local_origin` in world units; everything on the device is metres
    /// relative to it. Surfels that `clip` does not keep are not there for anything that reads the cut.
    Result<void> make_cut(Device& device, const octree::NodeSource& source, std::span<const CutEntry> entries,
                          const glm::dvec3& local_origin, DeviceCut& cut, const Clip& clip = {}) const;

    /// The cut's surfels with their footprints, decoded on the host by the same rules, in the order of their
    /// ids without the gaps: what the reference engine traces.
    std::vector<Surfel> download(const DeviceCut& cut) const;

 private:
    struct Resident {
        std::vector<uint32_t> pages;
        uint32_t count = 0;    ///< surfels
        uint64_t content = 0;  ///< hash of them
    };
    void upload(const Resident& node, std::span<const PackedSurfel> surfels);

    Buffer buffer_;
    std::unordered_map<uint32_t, Resident> resident_;
    std::vector<uint32_t> free_;  ///< pages, the next to be taken last
    uint32_t capacity_ = 0;       ///< surfels
};

}  // namespace lucarne::gi
