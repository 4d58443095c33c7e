#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gi/device/gl/device.h"
#include "gi/engines/vpl/seeding/seeding.h"
#include "gi/surfels/surfel_pool.h"

namespace lucarne::gi::vpl {

/// The emissive surfels of a cut.
struct Emitters {
    std::vector<double> running;  ///< sums of weights by id: area times luminance of the emission, W/sr
    Buffer scratch;

    double sum() const { return running.empty() ? 0.0 : running.back(); }
    /// Returns the flux that leaves both sides of all emitters, W.
    double flux() const { return 2 * 3.14159265358979 * sum(); }
};

/// Computes the weights of the surfels of a cut. `materials` comes from upload_materials(). Errors: no
/// device memory, a shader that fails.
Result<void> weigh_emitters(Device& device, const DeviceCut& cut, const Buffer& materials, Emitters& target);

/// Draws `count` surfels in proportion to their weights, one in each stratum of the running sums, and
/// returns id << 1 | side. The result is the same for the same seed.
std::vector<uint32_t> draw_emitters(std::span<const double> running, uint32_t count, uint64_t seed);

/// Places `count` VPLs on emitters, starting at VPL `first` of the target. Errors as above.
Result<void> seed_emitters(Device& device, const DeviceCut& cut, const Buffer& materials, Emitters& emitters,
                           uint32_t count, uint64_t seed, uint32_t first, Seeds& target);

}  // namespace lucarne::gi::vpl
