#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/convert/scans/unify.h"

namespace lucarne::octree {

/// Points of all inputs, spread over the whole of each, to be shown before anything has been built.
struct QuickSample {
    std::vector<std::byte> records;  ///< in the unified schema
    std::vector<glm::dvec3> positions;
    glm::dvec3 min{0.0}, max{0.0};  ///< bounds of the sample
    uint64_t points = 0;            ///< in the inputs, as far as their headers tell
    bool has_gaps = false;          ///< only fronts of parts were read
};

/// Called with the number of points read and their total (0: not known), on any thread. Returning false ends
/// the reading.
using Sampling = std::function<bool(uint64_t done, uint64_t total)>;

/// Takes at most `most` points (a few more if there are many inputs), from every input in proportion to its
/// number of points. Inputs that can seek are divided into as many equal runs of points as points are wanted;
/// one point at a random position of each run is read, in parallel, so the cost depends on `most`, not on the
/// file. Other inputs are read once from end to end, and every 2^k-th point is kept. The points are the same
/// for any number of threads. Errors: unreadable inputs, no points; `sampling` ended it.
Result<QuickSample> take_sample(const Unifier& inputs, uint64_t most, const Sampling& sampling = {});

/// Like take_sample, but reads at most about `read` points of the inputs that cannot seek: the fronts of
/// parts (PointSource::front) spread over each input, in parallel. So the cost depends on `most` and `read`,
/// not on the files, and the points cover the inputs less evenly. If several inputs are given, one that
/// cannot be read is left out with a warning.
Result<QuickSample> take_sketch(const Unifier& inputs, uint64_t most, uint64_t read,
                                const Sampling& sampling = {});

/// Returns the points of the sample and those of `records`, each once. Errors: no points.
Result<QuickSample> join(const Unifier& inputs, const QuickSample& sample, std::vector<std::byte> records);

/// Sets positions and bounds from the sample's records. Errors: no points.
Result<QuickSample> with_positions(const Unifier& inputs, QuickSample sample);

}  // namespace lucarne::octree
