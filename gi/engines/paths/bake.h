#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/bake/precomputation.h"
#include "gi/engines/paths/gathering_points.h"
#include "gi/engines/paths/groups.h"
#include "gi/engines/paths/light_paths.h"
#include "gi/engines/paths/native/near_points.h"
#include "gi/engines/paths/point_cells.h"

namespace lucarne::gi::paths {

/// Two gathering points, by their numbers.
struct PointPair {
    uint32_t first = 0, second = 0;
    bool operator==(const PointPair&) const = default;
};

/// What does not change while lights, cameras and materials do. Surfels are not needed any more.
struct LightPaths {
    std::vector<GatheringPoint> points;
    uint32_t rays_a_point = 0;
    std::vector<uint32_t> rays;  ///< of each point: the groups whose light they bring; kNone: none
    Groups groups;               ///< leaf_of is empty
    EntryPoints entries;
    Links links;
    /// Gathering points that are about each other but do not see each other.
    std::vector<PointPair> hidden;
    /// Of each entry point: the leaves of the kVertices - 1 vertices of its photon path.
    std::vector<uint32_t> photons;
};

/// An entry point: position, side, and what it reflects.
struct Entry {
    glm::vec3 position{0.0f}, normal{0.0f};
    float radius = 0;  ///< m
    glm::vec3 albedo{0.0f};
    uint32_t material = 0;
};

/// A gathering point and its share of the light at a place.
struct PointShare {
    uint32_t point = 0;
    float share = 0;
};

/// The gathering points of many places.
struct Sharing {
    std::vector<uint32_t> first;  ///< of each place: where its shares begin; and their end
    std::vector<PointShare> shares;

    std::span<const PointShare> of(size_t place) const {
        return std::span(shares).subspan(first[place], first[place + 1] - first[place]);
    }
};

/// The result of the precomputation. An engine may keep it longer than a frame.
class PathsBake final : public Bake, public std::enable_shared_from_this<PathsBake> {
 public:
    LightPaths paths;
    uint64_t seed = 0;                            ///< of the directions of the gathering rays
    std::vector<Entry> entries;                   ///< of paths.entries
    std::vector<GroupPlane> planes;               ///< of paths.groups
    PointCells near;                              ///< of the gathering points, with their reaches on pixels
    std::vector<native::PointBlock> near_blocks;  ///< the points of near.numbers()
    PointCells far;                               ///< likewise, for pixels that no reach covers
    Sharing sharing;                              ///< of the gathering points, with each other
};

extern const Precomputes kPathsPrecomputes;

}  // namespace lucarne::gi::paths
