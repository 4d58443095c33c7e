#pragma once

#include <atomic>
#include <span>
#include <vector>

#include "gi/gather/exchange.h"
#include "gi/gather/traced_tree.h"
#include "gi/shared/material.h"

namespace lucarne::gi {

/// Adds what the surfels reflect of VPLs to what they send out, evenly (`light`) and by lobes, both by
/// surfel; no lobes: nothing is glossy. This is instant radiosity at the points of the tree (Ritschel et al.
/// 2009, section 4; Keller 1997). For each bounce `settings.sources` VPLs stand on surfels, in proportion to
/// what these send out after the bounce before. A VPL is a disc of the area that it stands for, and shines
/// with the light of its surfel, so what is near to it is not too bright. Every surfel takes kVplsOfASurfel
/// of them, neighbours take others. Rays decide which it sees. The same arguments give the same light,
/// whatever the number of threads. Gives up if `stop` becomes true.
void add_light_of_vpls(const TracedTree& traced, std::span<const Material> materials,
                       const ExchangeSettings& settings, std::vector<SideLight>& light, SideLobes& lobes,
                       const std::atomic<bool>* stop = nullptr);

inline constexpr size_t kVplsOfASurfel = 16;

}  // namespace lucarne::gi
