#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/tree/surfel_tree.h"

namespace lucarne::gi::environment {

/// The sides of slots that primary points see, and of which the irradiance has to be known (Harada 2014,
/// section 3.3). Most of it follows from that of others: below a primary point all have the light of that
/// point, and what has only known children has their mean. A side is twice its slot, and one more for the
/// back.
class Secondaries {
 public:
    /// Finds out which sides have to gather. `seen` as MicroBuffers::seen(); `primaries`: their sides, none
    /// above another.
    void choose(const SurfelTree& tree, std::span<const uint32_t> seen, std::span<const uint32_t> primaries);
    /// Lets both sides of all surfels gather instead, to check choose().
    void choose_all(const SurfelTree& tree);

    /// The sides that have to gather.
    std::span<const uint32_t> gathering() const { return gathering_; }
    struct Counts {
        size_t seen = 0;        ///< sides that primary points see
        size_t after_up = 0;    ///< of these, without those with known children
        size_t after_down = 0;  ///< of these, without those below primary points: those that gather
    };
    const Counts& counts() const { return counts_; }

    /// Returns the irradiance of all sides from that of primaries and of gathering(), in their orders. Sides
    /// that nothing follows for have that of what is above or below them.
    std::vector<glm::vec3> propagate(const SurfelTree& tree, std::span<const glm::vec3> at_primaries,
                                     std::span<const glm::vec3> gathered) const;

 private:
    enum class State : uint8_t { unknown, seen, primary, copied, mean };
    void find_means(const SurfelTree& tree);
    size_t count_gathering() const;

    std::vector<State> states_;
    std::vector<uint32_t> primaries_, gathering_;
    Counts counts_;
};

}  // namespace lucarne::gi::environment
