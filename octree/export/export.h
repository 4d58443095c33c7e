#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "io/formats/scan.h"
#include "octree/tree/point_normals.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

struct ExportOptions {
    /// Write the normals that are drawn as `normal` where these are estimated. Caches whose estimated normals
    /// stand in place of the inputs' own are always written so.
    bool normals = false;
};

/// What of a cache goes back into a scan file: the inputs' attributes without those that the build added.
/// Inputs' own normals that estimated ones replace keep the name that the cache gives them
/// (octree/tree/stored_names.h).
class Exporter {
 public:
    Exporter(const NodeSource& source, const ExportOptions& options);

    const io::Schema& schema() const { return schema_; }
    /// What the writer needs to know; the details of the format where all inputs had the same.
    const io::ScanInfo& info() const { return info_; }
    /// What the points tell a writer before it gets them. Not longer than this.
    io::WriteOptions write_options(bool overwrite) const;
    /// Writes every point, node by node, and finishes the file. `progress` is told of points that are done.
    Result<void> write(io::PointWriter& writer, const std::function<void(uint64_t)>& progress) const;

    /// Writes a COPC file: its nodes are the source's, in their prefix order, each level's spacing half of
    /// that above. Nodes that divide one place's points (below kMaxLevel) are one, since COPC knows places
    /// alone.
    Result<void> write_copc(const std::filesystem::path& path, bool overwrite,
                            const std::function<void(uint64_t)>& progress) const;

 private:
    struct Copy {
        uint32_t from = 0, to = 0, bytes = 0;
    };
    /// Where scans have colours of 8 bits in 16 beside such of all 16: a file has one white for all.
    void find_narrow_colours();
    void spread_colour(const std::byte* in, std::byte* out) const;
    /// Appends `count` of a node's points in our schema, from `first` on.
    void append(const NodeData& data, size_t first, size_t count, std::vector<std::byte>& records) const;
    /// Shows every point, node by node, until `visit` is false.
    Result<void> visit_batches(const std::function<Result<bool>(std::span<const std::byte>)>& visit) const;
    /// Appends all points of a node, and with `below` of its descendants.
    Result<void> append_node(uint32_t node, bool below, std::vector<std::byte>& records) const;

    const NodeSource& source_;
    io::Schema schema_;
    io::ScanInfo info_;
    std::vector<Copy> copies_;
    struct Spread {
        std::vector<bool> narrow;      ///< scans whose colours are spread over 16 bits; empty: none
        uint32_t scan = 0, color = 0;  ///< where these stand, in the cache's records and in ours
    } spread_;
    PointNormals normals_;
    std::optional<io::Attribute> normal_;  ///< of our schema, where it is written from normals_
};

}  // namespace lucarne::octree
