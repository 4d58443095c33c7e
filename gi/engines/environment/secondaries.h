#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/host_frame.h"
#include "gi/tree/surfel_tree.h"

namespace lucarne::gi::environment {

/// The sides of slots that primary points see, and of which the irradiance has to be known (Harada 2014,
/// section 3.3). That of some follows from that of others: what is finer than the picture needs has the light
/// of what it is part of, and what has only known children has their mean. A side is twice its slot, and one
/// more for the back.
class Secondaries {
 public:
    /// Finds out which sides have to be known by themselves. `seen` as MicroBuffers::seen(); `fine(slot)`: it
    /// needs no distinction of its parts. What is below a fine slot has to be fine as well.
    void choose(const SurfelTree& tree, std::span<const uint32_t> seen,
                const std::function<bool(size_t)>& fine);
    /// Asks for both sides of all surfels instead, to check choose().
    void choose_all(const SurfelTree& tree);

    /// The sides that have to be known by themselves.
    std::span<const uint32_t> sides() const { return sides_; }
    /// How many sides the primary points see.
    size_t seen() const { return seen_; }

    /// Returns the irradiance of all sides from that of sides(), in their order. Sides that nothing follows
    /// for have that of what is above or below them.
    std::vector<glm::vec3> propagate(const SurfelTree& tree, std::span<const glm::vec3> light) const;

 private:
    enum class State : uint8_t { unknown, seen, part, mean };
    void find_means(const SurfelTree& tree);

    std::vector<State> states_;
    std::vector<uint32_t> sides_;
    size_t seen_ = 0;
};

/// Returns whether all parts of a slot may have the light of one of them: the slot is_fine() at this spacing,
/// and its surfels lie so near its plane that none hides light from another.
bool shares_light(const SurfelTree& tree, size_t slot, const CameraView& camera, float spacing);

}  // namespace lucarne::gi::environment
