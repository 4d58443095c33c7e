#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/engines/paths/bake.h"
#include "gi/host_frame.h"
#include "gi/tracing/surfel_tracer.h"

namespace lucarne::gi::paths {

/// Finds the gathering points whose light a surface point has. One finder serves many places, one after the
/// other.
class PointFinder {
 public:
    explicit PointFinder(const PathsBake& bake) : bake_(bake) {}
    /// Finds the points about a place, in the bake's coordinates, weighted by 1 - error_of(). If none reaches
    /// it, the one with the smallest error is taken. Returns whether any reaches it.
    bool find(const glm::vec3& position, const glm::vec3& normal);
    /// The same for a place whose light is blurred: only points whose normals differ little.
    bool find_alike(const glm::vec3& position, const glm::vec3& normal);
    /// The points found; their shares add up to 1. Empty: there is none.
    std::span<const PointShare> shares() const { return shares_; }

 private:
    bool find_within(float turn, const glm::vec3& position, const glm::vec3& normal);
    bool share_within(float turn, const glm::vec3& position, const glm::vec3& normal);
    void drop_hidden();

    const PathsBake& bake_;
    std::vector<PointShare> shares_;
    std::vector<uint32_t> found_;
};

/// Returns the irradiance at a place, W/m^2, from that of all gathering points (`irradiance`); black without
/// shares.
glm::vec3 irradiance_of(std::span<const PointShare> shares, std::span<const glm::vec3> irradiance);

/// Returns the points of many places. `find(finder, place)` finds those of one, and returns false if it has
/// none.
Sharing find_sharing(const PathsBake& bake, size_t places,
                     const std::function<bool(PointFinder&, size_t)>& find);
/// Finds which points each gathering point shares its light with: those about it, as pixels do.
class SharingFinder {
 public:
    /// `bake` must outlive it.
    explicit SharingFinder(const PathsBake& bake) : bake_(bake) {}
    /// Finds those of some more points. Returns whether any are left.
    bool advance();
    Sharing take() { return std::move(sharing_); }

 private:
    const PathsBake& bake_;
    Sharing sharing_{.first = {0}, .shares = {}};
};
/// Finds which shares belong to points that something hides from each other: by rays, since walls() of points
/// are coarse.
class HiddenFinder {
 public:
    /// The references must outlive it.
    HiddenFinder(const PathsBake& bake, const Sharing& sharing, const tracing::SurfelTracer& tracer)
        : bake_(bake), sharing_(sharing), tracer_(tracer) {}
    /// Tests the shares of some more points. Returns whether any are left.
    bool advance();
    /// The finished share, 0..1.
    double share() const;
    std::vector<PointPair> take() { return std::move(hidden_); }

 private:
    const PathsBake& bake_;
    const Sharing& sharing_;
    const tracing::SurfelTracer& tracer_;
    size_t next_ = 0;
    std::vector<PointPair> hidden_;
};
/// Leaves out shares of hidden points. `hidden`: of HiddenFinder, in its order.
Sharing without(const Sharing& sharing, std::span<const PointPair> hidden);

/// Lets gathering points share their light: it takes the blotches of their few rays away.
std::vector<glm::vec3> smooth(const PathsBake& bake, std::span<const glm::vec3> irradiance);

}  // namespace lucarne::gi::paths
