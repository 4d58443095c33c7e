#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/device/gl/device.h"
#include "gi/scene/scene.h"
#include "gi/shared/surfel.h"
#include "gi/surfels/cut_parts.h"
#include "gi/surfels/host_surfels.h"
#include "octree/tree/source.h"

namespace lucarne::gi {

class BakedLight;

/// Packs a node's points for the device: positions as fractions of the node's cube, colours to 10-bit sRGB
/// (.5 linear if the scan has none), normals from `normal` or `normal_oct`, areas from `area`. The material
/// is the last one in the scene whose conditions all hold ([0], the default, has none); materials beyond 256
/// are not used. Colours are those that the scene's look asks for (`first_scan` is added to the scan numbers
/// of the records). Points of hidden classes become outliers (kStrayArea), which are not drawn. `baked` is
/// divided out of the points' own colours, as far as the scene's albedo asks.
std::vector<PackedSurfel> pack_surfels(const octree::SourceHeader& header, const octree::NodeInfo& node,
                                       const octree::NodeData& data, const Scene& scene,
                                       uint32_t first_scan = 0, const BakedLight* baked = nullptr);

/// A point of a source: record `index` of what NodeSource::load() returns for `node`.
struct PointPlace {
    uint32_t node = 0, index = 0;
    bool operator==(const PointPlace&) const = default;
};

/// Maps the surfels of a cut to points of the source. Synthetic surfels are no points. It stays valid when
/// the cut is gone.
class CutPoints {
 public:
    explicit CutPoints(std::vector<CutParts::Run> runs) : runs_(std::move(runs)) {}
    /// Returns the point of an id in a G-buffer drawn from the cut; none for kNoSurfel and ids without a
    /// surfel.
    std::optional<PointPlace> find(uint32_t id) const;

 private:
    std::vector<CutParts::Run> runs_;
};

/// A cut on the device, made by SurfelPool::make_cut(). It is valid until one of its nodes is evicted or the
/// pool is destroyed. Its bindings are the same for every shader: see bind().
class DeviceCut {
 public:
    // See CutParts for the meaning of these.
    uint32_t surfels() const { return static_cast<uint32_t>(parts_.surfels); }
    uint32_t clipped() const { return static_cast<uint32_t>(parts_.clipped); }
    /// Workgroups of kBlockSurfels to dispatch.
    uint32_t blocks() const { return static_cast<uint32_t>(parts_.blocks.size()); }
    float size() const { return parts_.size; }
    uint64_t fingerprint() const { return parts_.fingerprint; }
    std::span<const CutNode> nodes() const { return parts_.nodes; }
    std::shared_ptr<const CutPoints> points() const { return points_; }
    std::span<const CutItem> items() const { return parts_.items; }
    std::span<const CutBlock> block_list() const { return parts_.blocks; }
    const DeviceClip& clip() const { return parts_.clip; }
    /// The pool's packed surfels, which CutBlock::first counts.
    const Buffer& pool() const { return *pool_; }
    /// Returns radii and bounds of the surfels. They are computed when first asked for. `pool` is the pool's
    /// mapped memory.
    const HostSurfels& on_host(std::span<const PackedSurfel> pool) const;
    /// Binds pool, items and blocks as texels to units 0 to 2, as gi/shared/cut.glsl declares them.
    void bind() const;

 private:
    friend class SurfelPool;
    const Buffer* pool_ = nullptr;
    Buffer items_, blocks_buffer_;
    CutParts parts_;  ///< without the runs, which `points_` has
    std::shared_ptr<const CutPoints> points_;
    mutable std::optional<HostSurfels> on_host_;
};

/// Owns the surfels of all resident nodes, in one buffer divided into pages of kPageSurfels. The stream's
/// load, replace and evict events feed it. A node takes any free pages, so fragmentation never wastes room.
class SurfelPool {
 public:
    static constexpr uint32_t kPageSurfels = gi::kPageSurfels;
    /// Makes a pool of `capacity` surfels (rounded up to pages), 16 bytes each. All memory is taken at once,
    /// so that the cap is hard. Errors: over the cap, out of device memory.
    static Result<SurfelPool> create(Device& device, uint32_t capacity);

    /// Loads a node, replacing it if it is resident. Returns false if there is no room; the caller then
    /// evicts nodes and tries again.
    Result<bool> load(uint32_t node, std::span<const PackedSurfel> surfels);
    void evict(uint32_t node);
    void evict_all();
    bool holds(uint32_t node) const;
    uint32_t used() const;  ///< pages in use, in surfels
    uint32_t capacity() const;

    /// Builds a cut from resident nodes. `entries` must contain the ancestors of every entry; entries that
    /// are not resident are left out with their descendants. `local_origin` is in world units; everything on
    /// the device is in metres relative to it. Surfels that `clip` removes do not exist for readers of the
    /// cut. `fillings` are drawn whole as far as they are resident: their nodes, one after the other, are
    /// loaded as kFirstFilled and the following numbers.
    Result<void> make_cut(Device& device, const octree::NodeSource& source, std::span<const CutEntry> entries,
                          const glm::dvec3& local_origin, DeviceCut& cut, const Clip& clip = {},
                          std::span<const octree::Filling> fillings = {}) const;

    /// Decodes the cut's surfels with their footprints on the host, by the same rules, in the order of their
    /// ids without the gaps. Engines that trace rays use them.
    std::vector<Surfel> download(const DeviceCut& cut) const;
    /// Calls visit(id, surfel) for each of them instead, for who keeps them otherwise.
    void each_surfel(const DeviceCut& cut, const std::function<void(uint32_t, const Surfel&)>& visit) const;

 private:
    void upload(const PlacedNode& node, std::span<const PackedSurfel> surfels);

    Buffer buffer_;
    PlacedNodes resident_;
    std::vector<uint32_t> free_;  ///< pages; the next one to take is at the end
    uint32_t capacity_ = 0;       ///< surfels
};

}  // namespace lucarne::gi
