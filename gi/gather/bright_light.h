#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/gather/gather_point.h"
#include "gi/gather/lit_tree.h"
#include "gi/gather/traced_tree.h"
#include "gi/gather/vpls.h"

namespace lucarne::gi {

/// Light that few rays of a micro-buffer find by chance: that of small surfaces, such as patches of sun,
/// which are much brighter than all else about the points that gather. It is taken out of what far buffers
/// see, and rays to VPLs on these surfaces bring it. At a distance d, VPLs bring d^2 / (d^2 + reach^2) of it,
/// and buffers the rest, so that no VPL is too near.
class BrightLight {
 public:
    /// Finds what is bright for some points (`pilots`) that receive a mean radiance of `typical`, W/(sr m^2):
    /// surfels that send out kBright times as much. `slots`: what the slots of the tree send out evenly. VPLs
    /// are chosen by what they bring to the pilots. The same arguments give the same light. Finds
    /// none if `stop` becomes true.
    static BrightLight find(const LitTree& scene, const TracedTree& traced, std::span<const SideLight> slots,
                            std::span<const GatherPoint> pilots, float typical, uint64_t seed,
                            const std::atomic<bool>* stop = nullptr);

    bool empty() const { return vpls_.empty(); }
    /// Of each slot: what of its radiance VPLs bring to far points, W/(sr m^2).
    SharedLight excess() const { return excess_; }
    /// Frees excess(), which nothing here needs.
    void drop_excess() { excess_ = {}; }
    float reach2() const { return reach2_; }  ///< m^2

    /// Returns the mean radiance, as Gatherer::gather() has it, that the VPLs bring to a point. `number`
    /// chooses some of them.
    glm::vec3 at(const GatherPoint& point, uint64_t number) const;
    /// Calls visit(direction, light) for those of these VPLs that the point sees. `light`: their parts of
    /// at().
    void each(const GatherPoint& point, uint64_t number,
              const std::function<void(const glm::vec3&, const glm::vec3&)>& visit) const;

    static constexpr float kBright = 8;
    static constexpr size_t kPilots = 128;  ///< that tell what is bright for a picture

 private:
    const TracedTree* traced_ = nullptr;
    SharedLight excess_;
    std::vector<VirtualLight> vpls_;
    float reach2_ = 0;
};

}  // namespace lucarne::gi
