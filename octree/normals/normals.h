#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "io/points.h"
#include "octree/normals/beyond.h"
#include "octree/tree/edge_line.h"

namespace lucarne::octree {

struct Box {
    glm::dvec3 min{0.0}, max{0.0};
};

/// Chunks [first, end).
struct ChunkRange {
    size_t first = 0, end = 0;
    bool contains(size_t chunk) const { return chunk >= first && chunk < end; }
};

/// Gives the normal estimator access to the chunks of an out-of-core build. Chunks are disjoint boxes that
/// together hold every point. All calls are thread-safe.
class ChunkAccess {
 public:
    virtual ~ChunkAccess() = default;
    virtual size_t chunk_count() const = 0;
    virtual Box bounds(size_t chunk) const = 0;  ///< half-open cell of the chunk
    virtual uint64_t point_count(size_t chunk) const = 0;
    /// Returns the positions of a chunk's points in their stored order.
    virtual Result<std::vector<glm::dvec3>> positions(size_t chunk) const = 0;
    /// Points of a chunk with their indices in its stored order.
    struct Part {
        std::vector<uint32_t> indices;
        std::vector<glm::dvec3> positions;
    };
    /// Returns the points of a chunk in a box, where reading the whole chunk is expensive because another
    /// process has it. Empty where it is not: then call positions().
    virtual Result<std::optional<Part>> far_points(size_t /*chunk*/, const Box& /*box*/) const {
        return std::nullopt;
    }
    /// Returns, for each point, the index into NormalOptions::stations of the station that saw it, -1 where
    /// unknown.
    virtual Result<std::vector<int32_t>> stations(size_t chunk) const = 0;
};

/// Memory that a chunk takes while it is processed, bytes a point (160 measured, and the reading of its
/// records). Chunks should be so small that a few fit into NormalOptions::memory at a time; one is processed
/// even if it does not fit.
inline constexpr uint64_t kNormalBytesPerPoint = 220;
inline constexpr uint32_t kMostNormalNeighbours = 127;

/// How neighbours are found. Both searches find the same neighbours, except that among several at equal
/// distance the choice may differ. Either way PCL fits the plane through them.
enum class NeighbourSearch {
    leaf,   ///< leaves of points along a Morton curve (leaf_index.h)
    flann,  ///< FLANN's kd-tree, PCL's default: for comparison
};

struct NormalOptions {
    NeighbourSearch search = NeighbourSearch::leaf;
    uint32_t neighbours = 16;  ///< neighbours of a point, without itself; 3 to kMostNormalNeighbours
    std::vector<glm::dvec3> stations;
    uint64_t memory = uint64_t{1} << 30;  ///< bytes that this stage may use in total
    unsigned threads = 0;
    bool normals = true;        ///< false: the normals are not oriented, because the input has its own
    bool site_normals = false;  ///< also return ChunkNormals::site_normals
    /// Length of the unit square in which areas are returned. Floats can represent the squares of neither
    /// 1e30 nor 1e-30, so for clouds of unknown size the caller passes the cloud's own extent.
    double area_unit = 1;
};

/// The area of an outlier, an isolated point in the air: it has no share of any surface and is not drawn. It
/// is so small that it is stored as the smallest area that a cache can represent.
inline constexpr float kStrayArea = 1e-30f;

/// The line at which a point's surface ends.
struct PointEdge {
    EdgeCode code = kNoEdge;  ///< for the point's normal and area
    Beyond beyond = Beyond::nothing;
    uint8_t narrowed = 255;  ///< share of the area that the point keeps at an outer edge, in 1/255

    /// Returns the share of the area that the point keeps, as soon as `beyond` is known for good.
    float kept() const { return beyond == Beyond::falls ? static_cast<float>(narrowed) / 255 : 1.0f; }
};
static_assert(sizeof(PointEdge) == 4);

/// The result for one chunk, in the order of its positions.
struct ChunkNormals {
    std::vector<glm::vec3> normals;  ///< unit; zero: no stable plane
    std::vector<float> areas;  ///< share of the surface (area_unit squared), 0 if unknown, or kStrayArea
    std::vector<PointEdge> edges;
    std::vector<uint32_t> components;  ///< the orientation component of the chunk to which each point belongs
    /// The normals of the neighbourhoods, which vote on the orientation; beside a crease, a point's own is
    /// that of its side. Empty unless NormalOptions::site_normals.
    std::vector<glm::vec3> site_normals;
};

/// signs[chunk][component]: the number of the connected surface that the component is a part of, from 1;
/// negative if the normals of the component have to be flipped.
using OrientationSigns = std::vector<std::vector<int32_t>>;

/// Estimates normals and areas of all chunks. Neighbours are found across chunk borders. `sink` receives each
/// chunk when it is done (in any order, on any thread, one call a chunk). The returned signs complete the
/// orientation: toward the station where it is known, else consistent along the surface. Results do not
/// depend on the thread count. Extents may be of any size, but points nearer to each other than 1e-34 of the
/// cloud's extent have no normal. Errors: a coordinate that is not a finite number, and what ChunkAccess
/// reports.
Result<OrientationSigns> estimate_normals(
    const ChunkAccess& chunks, const NormalOptions& options,
    const std::function<Result<void>(size_t chunk, ChunkNormals&&)>& sink);

}  // namespace lucarne::octree
