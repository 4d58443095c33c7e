#pragma once

#include "gi/device/gl/device.h"
#include "gi/engines/vpl/seeding/seeding.h"
#include "gi/engines/vpl/shadow_maps/shadow_maps.h"
#include "gi/surfels/surfel_pool.h"

namespace lucarne::gi::vpl {

/// What redistribution needs besides the VPLs.
struct Redistribution {
    Buffer odds;
    bool best_candidate = false;      ///< the paper's choice: biased, for comparison
    float footprint_variance = 6.0f;  ///< lobes.h
};

/// Makes `to` of one new VPL for every one of `from`, where its light falls by its shadow map, which was
/// drawn with its sources. `seed` decides the races; the same every run. `glossy` says whether any of
/// `materials` has a specular lobe. Errors: no device memory, a shader that fails.
Result<void> redistribute(Device& device, const DeviceCut& cut, const ShadowMaps& maps,
                          const Buffer& materials, bool glossy, uint32_t seed, const Seeds& from,
                          Redistribution& scratch, Seeds& to);

}  // namespace lucarne::gi::vpl
