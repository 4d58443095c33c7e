#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/formats/scan.h"
#include "octree/tree/point_normals.h"
#include "octree/tree/scan_number.h"
#include "octree/tree/source.h"

namespace lucarne::octree {

struct ExportOptions {
    /// Write the normals that are drawn as `normal` if they are estimated. Caches whose estimated normals
    /// replace the inputs' own are always written so.
    bool normals = false;
    std::vector<std::string> attributes{};  ///< names in the file of those to write; empty: all

    /// Whether a cube may contain points to write; null: any.
    std::function<bool(const Cube&)> meets{};
    /// Whether a point is to be written: its position (world units) and its record in the source's schema;
    /// null: any.
    std::function<bool(const glm::dvec3&, const std::byte*)> keeps{};
    /// If over 0: the mean distance between neighbouring points on surfaces, in the file's unit. Coarse nodes
    /// and prefixes are written whose points are at least so far apart, up to 1.4 times as far.
    double spacing = 0;
    /// If over 0: positions are rounded to multiples of it, in the file's unit, and stored as integers.
    /// check_precision() says whether they fit.
    double precision = 0;
    std::function<bool()> cancelled{};  ///< whether to end with an error before the next batch; null: never
    uint64_t every = 1;                 ///< writes each so many-th of the points that are left

    bool all_points() const { return !meets && !keeps && spacing <= 0 && every <= 1; }
};

/// Errors (arguments): positions rounded to `precision` do not fit 32-bit integers.
Result<void> check_precision(const SourceHeader& header, double precision);

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
    /// Writes the points, node by node, and finishes the file. Calls `progress` with numbers of points of the
    /// source that are done. Returns the number of points written.
    Result<uint64_t> write(io::PointWriter& writer, const std::function<void(uint64_t)>& progress) const;

    /// The same as a COPC file. Its nodes are the source's, in their prefix order; each level's spacing is
    /// half of that above. Nodes that divide the points of one place (below kMaxLevel) are joined to one,
    /// because COPC nodes are told apart by place alone.
    Result<uint64_t> write_copc(const std::filesystem::path& path, bool overwrite,
                                const std::function<void(uint64_t)>& progress) const;

 private:
    struct Copy {
        uint32_t from = 0, to = 0, bytes = 0;
    };
    /// Finds scans with 8-bit colours in 16-bit fields if others use all 16 bits: a file has one white for
    /// all.
    void find_narrow_colours();
    void spread_colour(const std::byte* in, std::byte* out) const;
    /// Returns how many of a node's first points may be written.
    uint32_t wanted(uint32_t node) const;
    /// Appends those of `count` points of a node, from `first` on, that are to be written, in the exporter's
    /// schema. `passed` counts the points that the other choices leave, for ExportOptions::every.
    void append(const NodeData& data, size_t first, size_t count, uint64_t& passed,
                std::vector<std::byte>& records) const;
    Result<void> check_cancelled() const;
    /// Visits the points to write, node by node, until `visit` returns false: their records and the number of
    /// points of the source that they were taken from.
    Result<void> visit_batches(
        const std::function<Result<bool>(std::span<const std::byte>, uint64_t)>& visit) const;
    /// Appends all points of a node and, if `below`, of its descendants.
    Result<void> append_node(uint32_t node, bool below, uint64_t& passed,
                             std::vector<std::byte>& records) const;

    const NodeSource& source_;
    ExportOptions options_;
    io::Schema schema_;
    io::ScanInfo info_;
    std::vector<Copy> copies_;
    struct Spread {
        std::vector<bool> narrow;       ///< scans whose colours are spread over 16 bits; empty: none
        ScanNumber scan{io::Schema{}};  ///< in the cache's records
        uint32_t color = 0;             ///< its offset in the exporter's
    } spread_;
    PointNormals normals_;
    std::optional<io::Attribute> normal_;  ///< in the exporter's schema, if it is written from normals_
};

}  // namespace lucarne::octree
