#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <glm/vec3.hpp>

#include "octree/convert/scans/unify.h"

namespace lucarne::octree {

/// Points of all inputs, spread over the whole of each: what can be shown before anything has been built.
struct QuickSample {
    std::vector<std::byte> records;  ///< in the unified schema
    std::vector<glm::dvec3> positions;
    glm::dvec3 min{0.0}, max{0.0};  ///< of the sample
    uint64_t points = 0;            ///< in the inputs as far as their headers tell
};

/// Told of points read and of how many there are (0: not known); false ends the reading. Any thread.
using Sampling = std::function<bool(uint64_t done, uint64_t total)>;

/// At most `most` points (a few more where there are many inputs), from every input in proportion to its
/// number of points. Inputs that seek give one point at a random place of each of as many equal runs of
/// points, read side by side: the cost follows from `most`, not from the file. The others are read once from
/// end to end, keeping every 2^k-th point. The same points for any number of threads. Errors: unreadable
/// inputs, no points; `sampling` ended it.
Result<QuickSample> take_sample(const Unifier& inputs, uint64_t most, const Sampling& sampling = {});

}  // namespace lucarne::octree
