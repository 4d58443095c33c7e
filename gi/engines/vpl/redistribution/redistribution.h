#pragma once

#include "gi/device/gl/device.h"
#include "gi/engines/vpl/seeding/seeding.h"
#include "gi/engines/vpl/shadow_maps/shadow_maps.h"
#include "gi/surfels/surfel_pool.h"

namespace lucarne::gi::vpl {

/// Settings and scratch memory of redistribution.
struct Redistribution {
    Buffer weight_sums;               ///< weight sums of the maps, W
    bool best_candidate = false;      ///< choose as the paper does: biased, for comparison
    float footprint_variance = 6.0f;  ///< lobes.h
};

/// Makes `to`: one new VPL for every VPL of `from`, placed where its light falls according to its shadow
/// map, which must have been drawn with its sources. `seed` decides the races, so the result is the same on
/// every run. `glossy` says whether any of `materials` has a specular lobe. Errors: no device memory, a
/// shader that fails.
Result<void> redistribute(Device& device, const DeviceCut& cut, const ShadowMaps& maps,
                          const Buffer& materials, bool glossy, uint32_t seed, const Seeds& from,
                          Redistribution& scratch, Seeds& to);

/// The same in parts: lets the texels of the maps from `first` to before `end` race, and completes the VPLs
/// once all maps have raced.
Result<void> race_maps(Device& device, const DeviceCut& cut, const ShadowMaps& maps, const Buffer& materials,
                       bool glossy, uint32_t seed, const Seeds& from, uint32_t first, uint32_t end,
                       Redistribution& scratch, Seeds& to);
Result<void> combine_races(Device& device, const DeviceCut& cut, const ShadowMaps& maps,
                           const Buffer& materials, bool glossy, const Seeds& from, Redistribution& scratch,
                           Seeds& to);

}  // namespace lucarne::gi::vpl
