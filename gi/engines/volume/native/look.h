#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace lucarne::gi::volume {

/// A cluster of lit faces, in preorder: its first child follows it, the second one after the first one's
/// clusters.
struct Cluster {
    glm::vec3 middle{0.0f};           ///< weighted by flux, m
    float radius = 0;                 ///< about the middle, of the sphere that holds all of its faces, m
    glm::vec3 low{0.0f}, high{0.0f};  ///< the box of its faces, m
    glm::vec3 normal{0.0f};           ///< mean, weighted by flux; shorter than 1 if normals differ
    float area = 0;                   ///< m^2
    glm::vec3 power{0.0f};            ///< sum of radiance * area, W/sr
    uint32_t face = 0;                ///< the one nearest to the middle, to which lines of sight go
    uint32_t voxel = 0;               ///< in which that face is
    uint32_t faces = 0;
};

/// A surface that light arrives at.
struct Receiver {
    glm::vec3 position{0.0f}, normal{0.0f};
    uint32_t voxel = 0;
};

/// What a cluster sends to a receiver if nothing is in between.
struct Ray {
    glm::vec3 light;   ///< W/m^2
    float luminance;   ///< of the light; kNearby: not computed yet
    uint32_t cluster;  ///< to whose face the line of sight goes
    /// Of single faces so near that they need the form factor of a square.
    static constexpr float kNearby = -1;
};

/// How many receivers are looked from at once, at most.
inline constexpr size_t kReceiversTogether = 16;

/// Adds to `rays`, by receiver, the clusters between `first` and `last` that light the receivers if nothing
/// is in between, in the order of the tree: those that look small from there. `receivers`: up to
/// kReceiversTogether, best of those that lie together. `in_plane`: what reaches less far above a receiver
/// lies in its plane, m.
void look(std::span<const Cluster> clusters, size_t first, size_t last, std::span<const Receiver> receivers,
          float in_plane, std::span<std::vector<Ray>> rays);

}  // namespace lucarne::gi::volume
