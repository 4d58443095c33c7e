#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/gather/gather_point.h"
#include "gi/gather/lit_tree.h"
#include "gi/tracing/surfel_tracer.h"

namespace lucarne::gi {

/// The surfels of a tree that rays can hit, in the order of its slots, with the lines at which they end.
struct TracedTree {
    /// `scene`: the tree of the frame's light cut. Errors: Embree's (out of memory).
    static Result<TracedTree> create(const Frame& frame, const LitTree& scene);

    std::unique_ptr<tracing::SurfelTracer> tracer;
    std::vector<uint32_t> slot_of;    ///< of each surfel of `tracer`: its slot in the tree
    std::vector<uint32_t> surfel_of;  ///< its number in the light cut
};

/// Returns where rays of a point start, as those of its micro-buffer.
glm::vec3 ray_start(const tracing::SurfelTracer& tracer, const GatherPoint& point);

}  // namespace lucarne::gi
