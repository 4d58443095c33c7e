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
/// A node's records are held in memory as a whole when it is drawn, so larger nodes are rejected. In bytes.
inline constexpr uint64_t kMostNodeBytes = uint64_t{256} << 20;

/// The content of the info record: the root cube, and the place of the hierarchy's root page.
struct Info {
    glm::dvec3 centre{0.0};
    double half_size = 0;
    double spacing = 0;  ///< of the root's points; halves with every level
    uint64_t page_offset = 0, page_bytes = 0;
    double gps_low = 0, gps_high = 0;

    static Info load(std::span<const std::byte> data);  ///< takes kInfoBytes
    std::vector<std::byte> bytes() const;
};

/// A node's key: its level and its cell, among 2^level cells per axis of the root cube.
struct VoxelKey {
    uint32_t level = 0, x = 0, y = 0, z = 0;
};

struct Node {
    VoxelKey key;
    laz::ChunkPlace chunk;  ///< zero if the node has no points
};

/// Returns whether the file begins like a COPC file; false if it cannot be read.
bool is_copc(const ByteSource& file);

/// Returns whether a file of this name should be COPC: it ends in .copc.laz.
bool is_name(const std::filesystem::path& path);

/// A COPC file with its hierarchy in memory. The points are read node by node. Thread-safe.
class File {
 public:
    /// Opens a file and reads all pages of the hierarchy. The file's size bounds the memory: pages and chunks
    /// must lie in the file and must not overlap, which also excludes cycles. Errors: pages or chunks that
    /// overlap or lie outside, keys outside the root cube, more points than their bytes can hold, nodes over
    /// kMostNodeBytes, a sum of points that differs from the header's, and everything that makes the file
    /// unreadable as LAZ.
    static Result<File> open(std::shared_ptr<const ByteSource> input);

    const Info& info() const { return info_; }
    const PointSource& scan() const { return *scan_; }      ///< the same points, read as LAZ
    std::span<const Node> nodes() const { return nodes_; }  ///< in the order of the pages
    /// The bounding box of the points: the header's box, cut to the root cube.
    glm::dvec3 min() const { return min_; }
    glm::dvec3 max() const { return max_; }
    /// Reads the points of a node as records of scan(). Errors: unreadable, damaged.
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
