#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "gi/frame.h"
#include "gi/scene/clip.h"
#include "gi/scene/views.h"
#include "gi/shared/surfel.h"
#include "gi/surfels/preparation.h"
#include "octree/stream/cut.h"

namespace lucarne::gi {

/// The surfels of a cut in host memory, made without a device.
struct HostCut {
    std::vector<Surfel> surfels;  ///< in the order of their ids, without gaps
    LocalFrame frame;             ///< meaning of their coordinates
    Bounds bounds;                ///< of the whole cloud, m
    uint64_t shapes = 0;          ///< hash of places, normals, radii and areas
    uint64_t colours = 0;         ///< hash of albedos and numbers of materials
};

/// Loads the nodes of a cut and decodes their surfels, and those of `fillings` if the cut has enough points
/// (fillings_of()): the same as on the device for equal `preparation`. Nodes are loaded one after the other;
/// beside the result (48 bytes a surfel) this takes 16 bytes a point. Errors: a node cannot be read; given up
/// (`stop`).
Result<HostCut> load_host_cut(const octree::NodeSource& source, const octree::Cut& cut,
                              const LocalFrame& frame, const SurfelPreparation& preparation,
                              const Clip& clip = {}, std::span<const octree::Filling> fillings = {},
                              const std::atomic<bool>* stop = nullptr);

}  // namespace lucarne::gi
