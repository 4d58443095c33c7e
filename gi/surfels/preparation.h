#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "gi/scene/scene.h"
#include "gi/surfels/baked_light.h"
#include "gi/surfels/surfel_pool.h"
#include "octree/tree/source.h"

namespace lucarne::gi {

using PackedNode = std::vector<PackedSurfel>;

/// Packs nodes into surfels on the loading threads, with the schema and unit of each part.
class SurfelPreparation {
 public:
    /// `scene` determines the materials and colours of points. Its boxes, scans and elevations refer to the
    /// whole source.
    SurfelPreparation(std::shared_ptr<const octree::NodeSource> source, const Scene& scene);
    /// Sets the scene for further nodes. Thread-safe. `baked` is the light to divide out of the colours, as
    /// far as the scene's albedo requests it; null: none.
    void set_scene(const Scene& scene, const BakedLight* baked = nullptr);
    /// Packs a loaded node. Thread-safe.
    PackedNode pack(uint32_t node, const octree::NodeData& data) const;
    /// Packs the synthetic surfels of a filling's node. Thread-safe.
    PackedNode pack(const octree::Filling& filling, uint32_t node) const;

 private:
    struct OfPart;
    std::shared_ptr<const std::vector<OfPart>> parts() const;

    std::shared_ptr<const octree::NodeSource> source_;
    mutable std::mutex mutex_;
    struct OfPart {
        Scene scene;
        std::optional<BakedLight> baked;
    };
    std::shared_ptr<const std::vector<OfPart>> parts_;
};

}  // namespace lucarne::gi
