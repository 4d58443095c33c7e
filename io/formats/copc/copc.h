#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "io/formats/las/laz/reader.h"

// COPC: LAZ whose chunks are the nodes of an octree. Source: "COPC - Cloud Optimized Point Cloud" 1.0 (Hobu,
// 2021, copc.io).
namespace lucarne::io::copc {

inline constexpr std::string_view kUser = "copc";
inline constexpr uint16_t kInfoRecord = 1, kHierarchyRecord = 1000;
inline constexpr size_t kInfoBytes = 160, kEntryBytes = 32;
inline constexpr uint32_t kMostLevel = 31;
/// A node is held whole when it is drawn: no larger ones are read, bytes of its records.
inline constexpr uint64_t kMostNodeBytes = uint64_t{256} << 20;

/// What the info record says: the root cube, and where the root page of the hierarchy is.
struct Info {
    glm::dvec3 centre{0.0};
    double half_size = 0;
    double spacing = 0;  ///< of the root's points, half of it a level further down
    uint64_t page_offset = 0, page_bytes = 0;
    double gps_low = 0, gps_high = 0;

    static Info load(std::span<const std::byte> data);  ///< kInfoBytes
    std::vector<std::byte> bytes() const;
};

/// A node's place: its cell among 2^level per axis of the root cube.
struct VoxelKey {
    uint32_t level = 0, x = 0, y = 0, z = 0;
};

struct Node {
    VoxelKey key;
    laz::ChunkPlace chunk;  ///< of no points: none
};

/// Whether the file begins as COPC must; false where it cannot be read.
bool is_copc(const ByteSource& file);

/// Whether a file of this name is to be COPC: it ends in .copc.laz.
bool is_name(const std::filesystem::path& path);

/// A COPC file with its hierarchy in memory; the points are read node by node. Thread-safe.
class File {
 public:
    /// Reads all pages of the hierarchy. Memory is bounded by the file's size: pages and chunks must lie in
    /// the file and must not overlap, so cycles end there. Errors: pages or chunks that do, keys outside the
    /// root cube, more points than their bytes can hold, nodes over kMostNodeBytes, another sum of points
    /// than the header's, and what makes it no LAZ that can be read.
    static Result<File> open(std::shared_ptr<const ByteSource> input);

    const Info& info() const { return info_; }
    const PointSource& scan() const { return *scan_; }      ///< the same points as LAZ
    std::span<const Node> nodes() const { return nodes_; }  ///< in the order of the pages
    /// The box of the points as the header has it, cut to the root cube.
    glm::dvec3 min() const { return min_; }
    glm::dvec3 max() const { return max_; }
    /// The points of a node in the records of scan(). Errors: unreadable, damaged.
    Result<std::vector<std::byte>> read(size_t node) const;

 private:
    File() = default;
    Result<void> read_box();

    Info info_;
    std::shared_ptr<const PointSource> scan_;
    laz::Points points_;
    std::vector<Node> nodes_;
    glm::dvec3 min_{0.0}, max_{0.0};
};

}  // namespace lucarne::io::copc
