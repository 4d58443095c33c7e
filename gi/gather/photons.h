#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "gi/gather/lit_tree.h"
#include "gi/shared/material.h"
#include "gi/tracing/exposure.h"
#include "gi/tracing/surfel_tracer.h"

namespace lucarne::gi {

/// Light between surfels by photons (Jensen 1996, "Global illumination using photon maps"; Ritschel et al.
/// 2009, section 4, gather from such maps). They leave lit surfels, in proportion to what these send out, and
/// are reflected by both lobes. The irradiance of a surfel is the flux of the photons on it, and on others
/// about it in the tree, over the area of them that light can meet (gi/tracing/exposure.h). Surfels' own
/// shares of the surface would not do: in gaps of scans a surfel with a small share receives much light.
class Photons {
 public:
    /// Takes the surfels of a tree. Errors: Embree's (out of memory).
    Result<void> set_surfels(const LitTree& scene);

    struct Settings {
        uint64_t photons = 0;    ///< how many leave the lit surfels
        uint32_t bounces = 0;    ///< reflections that they have after that, at least one
        bool only_last = false;  ///< compute the light of the last one alone
        uint64_t seed = 0;
    };
    /// Adds what the surfels reflect of photons to what they send out, evenly (`light`) and by lobes, both by
    /// surfel; photons leave by these as well. Replaces them if `only_last`. No lobes: nothing is glossy. The
    /// same arguments give the same light, whatever the number of threads. Gives up if `stop` becomes true.
    void trace(const LitTree& scene, std::span<const Material> materials, const Settings& settings,
               std::vector<SideLight>& light, SideLobes& lobes,
               const std::atomic<bool>* stop = nullptr) const;

 private:
    std::unique_ptr<tracing::SurfelTracer> tracer_;
    std::vector<uint32_t> slot_of_;             ///< of each surfel of tracer_: its slot in the tree
    std::vector<tracing::Exposure> exposures_;  ///< of each surfel of tracer_
    std::vector<uint32_t> parent_of_;           ///< of each node: the slot whose child it is
};

}  // namespace lucarne::gi
