#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace lucarne::octree {

/// A point of the sample of a scan in which holes are looked for.
struct HolePoint {
    glm::vec3 position{0.0f};  ///< m
    glm::vec3 normal{0.0f};    ///< unit, toward the side that was scanned; points without one are not used
    glm::vec3 colour{0.5f};    ///< linear
    float area = 0;            ///< share of the surface in the sample, m^2
    int32_t station = -1;      ///< index in HoleSample::stations; -1: unknown
};

struct HoleSample {
    std::vector<HolePoint> points;
    std::vector<glm::vec3> stations;  ///< m
};

/// A surfel that nothing measured: it stands in a hole of the scan.
struct FillPoint {
    glm::vec3 position{0.0f}, normal{0.0f}, colour{0.0f};  ///< as in HolePoint
    float area = 0;                                        ///< m^2
};

struct FoundHoles {
    std::vector<FillPoint> points;
    std::vector<glm::vec3> tripods;  ///< the middles of round holes of floors, if no station is known, m
};

struct HoleLimits {
    size_t most_points = 1 << 17;    ///< of the result
    uint64_t memory = 256ull << 20;  ///< bytes for the search, beside the sample
};

/// Finds holes of a scan whose surroundings determine what is missing, and returns an even pattern of
/// surfels that fills them. A hole lies in a plane of the scan, is bounded by the plane's points and by
/// creases with other planes, and no station can have looked through it: it is hidden behind nearer points or
/// below the tripod. Without stations only small holes of floors count that have nothing below them.
/// The result does not depend on threads. Time and memory are bounded for any input.
FoundHoles find_holes(const HoleSample& sample, const HoleLimits& limits = {});

}  // namespace lucarne::octree
