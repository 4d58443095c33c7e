#pragma once

#include <memory>
#include <string>
#include <vector>

#include "io/points.h"

namespace lucarne::io {

/// How a virtual scan is made. The same options give the same bytes, whatever the threads and the batches.
struct SyntheticOptions {
    std::string scene = "cornell";  ///< one of synthetic_scenes()
    uint64_t points = 1'000'000;    ///< about how many for scans, exactly for even sampling
    uint32_t stations = 0;          ///< 0: the scene's own; more are placed where there is room
    bool even = false;     ///< evenly by area, hidden surfaces too, without noise, instead of scanning
    bool normals = false;  ///< keep the true normals (attribute `normal`)
    double noise = 0.002;  ///< standard deviation of the range, metres
    uint64_t seed = 1;
};

struct SyntheticScene {
    std::string name, summary;
};
/// Those with a true surface.
const std::vector<SyntheticScene>& synthetic_scenes();
/// And a cloud without one, made as large as one likes for benchmarks: a town as a scanner on a car's roof
/// delivers it, 1 mm, with noise in position, colour and intensity, trees and wild ranges.
const SyntheticScene& synthetic_survey();

/// A virtual scan as a stream: nothing is held but a few batches and the scene. Positions are in steps of 0.1
/// mm; attributes: intensity u16, color u8 x3 (the albedo), point_source_id u16 (the station, from 1; not
/// with `even`) and normal f32 x3 (on request). Station poses are in info(). Errors: ErrorKind::arguments,
/// naming the option.
Result<std::unique_ptr<PointSource>> synthetic_source(const SyntheticOptions& options);

}  // namespace lucarne::io
