#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "gi/scene/scene.h"
#include "gi/surfels/baked_light.h"
#include "gi/surfels/surfel_pool.h"
#include "octree/tree/source.h"

namespace lucarne::viewer {

/// Packs nodes into surfels on the loading threads, by each part's own schema and unit.
class SurfelPreparation {
 public:
    /// `scene` says which materials and colours points have; its boxes, scans and elevations are of the whole
    /// source.
    SurfelPreparation(std::shared_ptr<const octree::NodeSource> source, const gi::Scene& scene);
    /// For nodes from now on. Thread-safe.
    /// `baked` is divided out of the colours, as far as the scene's albedo asks; or none.
    void set_scene(const gi::Scene& scene, const gi::BakedLight* baked = nullptr);
    /// For octree::ResidencyOptions::prepare. Thread-safe.
    octree::NodeData pack(uint32_t node, octree::NodeData&& data) const;

 private:
    std::shared_ptr<const octree::NodeSource> source_;
    mutable std::mutex mutex_;
    struct OfPart {
        gi::Scene scene;
        std::optional<gi::BakedLight> baked;
    };
    std::shared_ptr<const std::vector<OfPart>> parts_;
};

/// What it made of a node.
std::span<const gi::PackedSurfel> prepared_surfels(const octree::NodeData& data);

}  // namespace lucarne::viewer
