#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/gather/gatherer.h"
#include "gi/gather/lit_tree.h"
#include "gi/gather/places.h"

namespace lucarne::gi {

/// Exchanges light between surfels (Ritschel et al. 2009, section 4; Jacobi iteration with push and pull,
/// Cohen & Wallace 1993). A number of surfels, one of each node of a level of the tree, gather; those about
/// them in their plane get the same irradiance, and reflect it each with its own albedo. All reflections
/// use the same micro-buffers, which are kept: drawing them takes longer than lighting them.
class Radiosity {
 public:
    /// Chooses at most 2^level places (places.h), others for each seed; does nothing if it has chosen these
    /// of the same tree. Errors: the device failed.
    Result<void> choose_places(ClDevice& device, const LitTree& scene, Gatherer& gatherer, uint32_t level,
                               uint64_t seed, const std::atomic<bool>* stop = nullptr);

    struct Settings {
        uint32_t bounces = 0;    ///< reflections to compute beyond the own light
        bool sky = false;        ///< the surfels also reflect the sky of the gatherer
        bool only_last = false;  ///< return the light of the last one alone
        uint32_t side = 16;      ///< of micro-buffers
        uint64_t seed = 0;
    };
    /// Sets the light that each surfel sends out after all these reflections. Leaves out the rest if `stop`
    /// becomes true. Errors: the device failed.
    Result<void> compute(ClDevice& device, const LitTree& scene, Gatherer& gatherer, const Settings& settings,
                         std::vector<SideLight>& light, const std::atomic<bool>* stop = nullptr);

    size_t places() const { return points_.size() / 2; }

 private:
    /// Sets the mean radiance that each of `points` receives, W/(sr m^2).
    Result<void> gather(ClDevice& device, Gatherer& gatherer, Gathered what, const Settings& settings,
                        std::span<const GatherPoint> points, std::span<glm::vec3> gathered,
                        const std::atomic<bool>* stop);

    /// What the places depend on.
    struct Basis {
        std::weak_ptr<const SurfelTree> tree;
        uint32_t level = 0;
        uint64_t seed = 0;
    };

    Basis places_of_;
    MicroBuffers buffers_;
    std::vector<GatherPoint> points_;  ///< two a place: its surfel's front and back
    std::vector<uint32_t> sides_;      ///< by side of surfels: the point that gathers for it (places.h)
};

}  // namespace lucarne::gi
