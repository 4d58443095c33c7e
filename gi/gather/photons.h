#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "gi/gather/exchange.h"
#include "gi/gather/lit_tree.h"
#include "gi/gather/traced_tree.h"
#include "gi/shared/material.h"
#include "gi/tracing/exposure.h"

namespace lucarne::gi {

/// Light between surfels by photons (Jensen 1996, "Global illumination using photon maps"; Ritschel et al.
/// 2009, section 4, gather from such maps). They leave lit surfels, in proportion to what these send out, and
/// are reflected by both lobes. The irradiance of a surfel is the flux of the photons on it, and on others
/// about it in the tree, over the area of them that light can meet (gi/tracing/exposure.h). Surfels' own
/// shares of the surface would not do: in gaps of scans a surfel with a small share receives much light. A
/// side that others cover has the irradiance of what covers it: nodes are means of all their surfels.
class Photons {
 public:
    /// Takes the surfels of a tree. `traced` is made from it. Gives up if `stop` becomes true: it must not be
    /// used then.
    void set_surfels(const LitTree& scene, const TracedTree& traced, const std::atomic<bool>* stop = nullptr);

    /// Adds what the surfels reflect of photons (`settings.sources` of them) to what they send out, evenly
    /// (`light`) and by lobes, both by surfel; photons leave by these as well. No lobes: nothing is glossy.
    /// The same arguments give the same light, whatever the number of threads. Gives up if `stop` becomes
    /// true.
    void trace(const LitTree& scene, const TracedTree& traced, std::span<const Material> materials,
               const ExchangeSettings& settings, std::vector<SideLight>& light, SideLobes& lobes,
               const std::atomic<bool>* stop = nullptr) const;

 private:
    std::vector<tracing::Exposures> exposures_;  ///< of each traced surfel
    /// Of each side (twice the traced surfel, and one more for its back): itself, or the side that covers it.
    std::vector<uint32_t> shown_;
    std::vector<uint32_t> parent_of_;  ///< of each node: the slot whose child it is
};

}  // namespace lucarne::gi
