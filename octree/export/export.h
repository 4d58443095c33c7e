#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "io/formats/scan.h"
#include "octree/tree/point_normals.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

struct ExportOptions {
    /// Write the normals that are drawn as `normal` if they are estimated. Caches whose estimated normals
    /// replace the inputs' own are always written so.
    bool normals = false;
};

/// Writes a cache back to a scan file: the inputs' attributes without those that the build added. Inputs' own
/// normals that estimated ones replace keep the name that the cache gives them (octree/tree/stored_names.h).
class Exporter {
 public:
    Exporter(const NodeSource& source, const ExportOptions& options);

    const io::Schema& schema() const { return schema_; }
    /// What the writer needs to know, including the details of the format if all inputs had the same.
    const io::ScanInfo& info() const { return info_; }
    /// What a writer must know about the points before it gets them. Must not outlive this object.
    io::WriteOptions write_options(bool overwrite) const;
    /// Writes every point, node by node, and finishes the file. Calls `progress` with numbers of finished
    /// points.
    Result<void> write(io::PointWriter& writer, const std::function<void(uint64_t)>& progress) const;

    /// Writes a COPC file. Its nodes are the source's, in their prefix order; each level's spacing is half of
    /// that above. Nodes that divide the points of one place (below kMaxLevel) are joined to one, because
    /// COPC nodes are told apart by place alone.
    Result<void> write_copc(const std::filesystem::path& path, bool overwrite,
                            const std::function<void(uint64_t)>& progress) const;

 private:
    struct Copy {
        uint32_t from = 0, to = 0, bytes = 0;
    };
    /// Finds scans with 8-bit colours in 16-bit fields if others use all 16 bits: a file has one white for
    /// all.
    void find_narrow_colours();
    void spread_colour(const std::byte* in, std::byte* out) const;
    /// Appends `count` of a node's points in the exporter's schema, from `first` on.
    void append(const NodeData& data, size_t first, size_t count, std::vector<std::byte>& records) const;
    /// Visits every point, node by node, until `visit` returns false.
    Result<void> visit_batches(const std::function<Result<bool>(std::span<const std::byte>)>& visit) const;
    /// Appends all points of a node and, if `below`, of its descendants.
    Result<void> append_node(uint32_t node, bool below, std::vector<std::byte>& records) const;

    const NodeSource& source_;
    io::Schema schema_;
    io::ScanInfo info_;
    std::vector<Copy> copies_;
    struct Spread {
        std::vector<bool> narrow;  ///< scans whose colours are spread over 16 bits; empty: none
        /// Offsets of these attributes in the cache's records and in the exporter's.
        uint32_t scan = 0, color = 0;
    } spread_;
    PointNormals normals_;
    std::optional<io::Attribute> normal_;  ///< in the exporter's schema, if it is written from normals_
};

}  // namespace lucarne::octree
