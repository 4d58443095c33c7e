#pragma once

#include <memory>
#include <string>
#include <vector>

#include "io/points.h"

namespace lucarne::io {

/// How a virtual scan is made. The same options give the same bytes on every machine and thread count.
struct SyntheticOptions {
    std::string scene = "cornell";  ///< one of synthetic_scenes()
    uint64_t points = 1'000'000;    ///< about how many for scans, exactly for even sampling
    uint32_t stations = 0;          ///< 0: the scene's own stations, and `even` when it has none
    bool even = false;              ///< blue-noise-like sampling by area instead of scanning
    bool normals = false;           ///< keep the true normals (attribute `normal`)
    double noise = 0.002;           ///< standard deviation of the range, metres
    uint64_t seed = 1;
};

std::vector<std::string> synthetic_scenes();

/// A virtual scan as a stream: nothing is held but one batch and the scene. Station poses are in info().
Result<std::unique_ptr<PointSource>> synthetic_source(const SyntheticOptions& options);

}  // namespace lucarne::io
