#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "gi/scene/scene.h"
#include "gi/scene/surfel_pool.h"
#include "octree/source.h"

namespace lucarne::viewer {

/// For octree::ResidencyOptions::prepare: packs nodes into surfels on the loading threads, by each part's own
/// schema and unit. `scene` says which materials points have; its boxes and scans are of the whole source.
std::function<octree::NodeData(uint32_t, octree::NodeData&&)> prepare_surfels(
    std::shared_ptr<const octree::NodeSource> source, const gi::Scene& scene);

/// What prepare_surfels made of a node.
std::span<const gi::PackedSurfel> prepared_surfels(const octree::NodeData& data);

}  // namespace lucarne::viewer
