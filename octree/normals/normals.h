#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <glm/vec3.hpp>

#include "io/points.h"

namespace lucarne::octree {

struct Box {
    glm::dvec3 min{0.0}, max{0.0};
};

/// The chunks of an out-of-core build, as the normal estimator sees them. Chunks are disjoint boxes that
/// together hold every point; all calls are thread-safe.
class ChunkAccess {
 public:
    virtual ~ChunkAccess() = default;
    virtual size_t chunk_count() const = 0;
    virtual Box bounds(size_t chunk) const = 0;  ///< half-open cell of the chunk
    virtual uint64_t point_count(size_t chunk) const = 0;
    /// Positions of a chunk's points in their stored order.
    virtual Result<std::vector<glm::dvec3>> positions(size_t chunk) const = 0;
    /// The index into NormalOptions::stations of the station that saw each point, -1 where unknown.
    virtual Result<std::vector<int32_t>> stations(size_t chunk) const = 0;
};

/// What a chunk takes while it is worked on, bytes a point (160 measured, and the reading of its records):
/// chunks should be small enough that a few fit in NormalOptions::memory at a time (one is worked on even if
/// it does not).
inline constexpr uint64_t kNormalBytesPerPoint = 220;
inline constexpr uint32_t kMostNormalNeighbours = 127;

/// How neighbours are found. Both find the same ones; where several are at one distance, which of them may
/// differ. Either way the plane through them is PCL's.
enum class NeighbourSearch {
    leaf,   ///< leaves of points along a Morton curve (leaf_index.h)
    flann,  ///< FLANN's kd-tree, which PCL takes by default: to compare with
};

struct NormalOptions {
    NeighbourSearch search = NeighbourSearch::leaf;
    uint32_t neighbours = 16;  ///< besides the point itself; 3 to kMostNormalNeighbours
    std::vector<glm::dvec3> stations;
    uint64_t memory = uint64_t{1} << 30;  ///< bytes that this stage may hold in all
    unsigned threads = 0;
    bool normals = true;  ///< false: only areas (the input has its own normals)
    /// Areas are given in squares of this length. Floats hold the squares of neither 1e30 nor 1e-30, so
    /// clouds of unknown size take their own extent.
    double area_unit = 1;
};

/// The area of a point that hangs in the air, isolated: not a share of anything, and not to be drawn. Small
/// enough to come out as the smallest that a cache can hold.
inline constexpr float kStrayArea = 1e-30f;

/// Of one chunk, in the order of its positions.
struct ChunkNormals {
    std::vector<glm::vec3> normals;    ///< unit, or zero: no stable plane
    std::vector<float> areas;          ///< surface share (area_unit squared), 0: unknown, or kStrayArea
    std::vector<uint32_t> components;  ///< which of the chunk's orientation components the point belongs to
};

/// signs[chunk][component]: +1 keep, -1 flip the normals of that component.
using OrientationSigns = std::vector<std::vector<int8_t>>;

/// Estimates normals and areas of all chunks; neighbours are found across chunk borders. `sink` takes each
/// chunk as it is done (any order, any thread, one call a chunk); the signs returned make the orientation
/// whole: toward the station where it is known, else consistent along the surface. Results do not depend on
/// the thread count. Extents may be of any size; points nearer to each other than 1e-34 of the cloud's extent
/// have no normal. Errors: a coordinate that is not a finite number, and what ChunkAccess reports.
Result<OrientationSigns> estimate_normals(
    const ChunkAccess& chunks, const NormalOptions& options,
    const std::function<Result<void>(size_t chunk, ChunkNormals&&)>& sink);

}  // namespace lucarne::octree
