#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gi/device/gl/device.h"
#include "gi/engines/vpl/seeding/seeding.h"
#include "gi/surfels/surfel_pool.h"

namespace lucarne::gi::vpl {

/// The surfels of a cut that shine by themselves.
struct Emitters {
    std::vector<double> running;  ///< sums of the ids' weights: area times luminance of the emission, W/sr
    Buffer scratch;

    double sum() const { return running.empty() ? 0.0 : running.back(); }
    /// What leaves them on both sides, W.
    double flux() const { return 2 * 3.14159265358979 * sum(); }
};

/// Weighs a cut's surfels. `materials` is what upload_materials made. Errors: no device memory, a shader that
/// fails.
Result<void> weigh_emitters(Device& device, const DeviceCut& cut, const Buffer& materials, Emitters& target);

/// Ids of `count` surfels, each drawn with the probability of its weight, one a stratum of the running sums:
/// id << 1 | side. The same for the same seed.
std::vector<uint32_t> draw_emitters(std::span<const double> running, uint32_t count, uint64_t seed);

/// Places `count` VPLs on emitters, from VPL `first` of the target on. Errors as above.
Result<void> seed_emitters(Device& device, const DeviceCut& cut, const Buffer& materials, Emitters& emitters,
                           uint32_t count, uint64_t seed, uint32_t first, Seeds& target);

}  // namespace lucarne::gi::vpl
