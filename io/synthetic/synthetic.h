#pragma once

#include <memory>
#include <string>
#include <vector>

#include "io/points.h"

namespace lucarne::io {

/// How a virtual scan is made. The same options give the same bytes, for any number of threads and any batch
/// size.
struct SyntheticOptions {
    std::string scene = "cornell";  ///< one of synthetic_scenes()
    uint64_t points = 1'000'000;    ///< approximate for scans, exact for even sampling
    uint32_t stations = 0;          ///< 0 means the scene's own; further ones are placed where there is room
    bool even = false;              ///< no scan: even by area, without noise, hidden surfaces too
    bool normals = false;           ///< keep the true normals (attribute `normal`)
    double noise = 0.002;           ///< standard deviation of the range, metres
    uint64_t seed = 1;
};

struct SyntheticScene {
    std::string name, summary;
};
/// Returns the scenes with a true surface.
const std::vector<SyntheticScene>& synthetic_scenes();
/// Returns the scene without a true surface, which benchmarks can make as large as they need: a town as a
/// scanner on a car's roof records it, rounded to 1 mm, with noise in position, colour and intensity, trees
/// and wild ranges.
const SyntheticScene& synthetic_survey();

/// Returns a virtual scan as a stream, which holds only a few batches and the scene. Positions are in steps
/// of 0.1 mm. Attributes: intensity u16, color u8 x3 (the albedo), point_source_id u16 (the station, from 1;
/// not with `even`) and normal f32 x3 (on request). Station poses are in info(). Errors:
/// ErrorKind::arguments, naming the option.
Result<std::unique_ptr<PointSource>> synthetic_source(const SyntheticOptions& options);

}  // namespace lucarne::io
