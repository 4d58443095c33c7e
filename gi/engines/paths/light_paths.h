// Where light enters, and the ways that it can take from there: chosen without any knowledge of lights.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/paths/groups.h"
#include "gi/engines/paths/sides.h"
#include "gi/tracing/surfel_tracer.h"

namespace lucarne::gi::paths {

/// The entry points of Yue et al. 2007, section 5.1: sides at which the light of lamps is computed. Each
/// stands for an equal part of its leaf's area, so that the areas of all add up to that of the surface.
struct EntryPoints {
    std::vector<Side> sides;
    std::vector<uint32_t> first;  ///< of each leaf, and the end
    bool operator==(const EntryPoints&) const = default;
};

/// Chooses about `count` entry points, in proportion to area, but at least one in each leaf that `used`
/// names, and none in others.
EntryPoints choose_entries(std::span<const Surfel> surfels, const GroupBuilder& builder,
                           std::span<const float> areas, std::span<const uint8_t> used, uint64_t count);

/// Rays of a leaf that tell how the light of others reaches it.
inline constexpr uint32_t kLinks = 64;
/// Traces kLinks rays from all over each of the leaves [first, last) into `hits`, which starts at leaf
/// `first`.
void trace_links(const tracing::SurfelTracer& tracer, const GroupBuilder& builder, uint32_t first,
                 uint32_t last, uint64_t seed, std::span<RayHit> hits);

/// Vertices of a photon path, its entry point included: bounces 1 to 4.
inline constexpr uint32_t kVertices = 4;
/// Traces a path from each of the entry points [first, last): cosine directions at every vertex. Sets the
/// leaves of the kVertices - 1 vertices after each entry point, kNone where the path has left the scene.
void trace_photons(const tracing::SurfelTracer& tracer, std::span<const uint32_t> leaf_of,
                   const EntryPoints& entries, size_t first, size_t last, uint64_t seed,
                   std::span<uint32_t> leaves);

}  // namespace lucarne::gi::paths
