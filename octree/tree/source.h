#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/points.h"
#include "octree/tree/nodes.h"
#include "octree/tree/station_colour.h"

namespace lucarne::octree {

/// A loaded node: `count` records in the schema's layout, in prefix order.
struct NodeData {
    uint32_t count = 0;
    std::vector<std::byte> records;
};

/// The most surfels that fill the holes of a cache.
inline constexpr uint64_t kMostFilled = 1 << 17;

/// Where a cache stores the surfels that fill holes of its scans (octree/holes), as a payload like a node's.
struct FillingSection {
    io::Schema schema;
    uint64_t points = 0;  ///< 0: no hole was found, and nothing is stored
    uint64_t offset = 0, bytes = 0, checksum = 0;
    uint8_t codec = 0;
    bool operator==(const FillingSection&) const = default;
};

/// Where a cache stores what its directory's pages need to be read one by one (octree/FORMAT.md).
struct DirectoryPages {
    uint32_t nodes = 0;  ///< of each page but the last
    uint64_t offset = 0, checksum = 0;
    bool operator==(const DirectoryPages&) const = default;
};

/// A place where a scanner stood, as the points show; no file states it (octree/stations).
struct EstimatedStation {
    uint32_t scan = 0;         ///< index in SourceHeader::scans
    glm::dvec3 position{0.0};  ///< in the coordinates of the points
    bool saw_all = false;      ///< it saw all points of the scan, whose only station it is
    bool operator==(const EstimatedStation&) const = default;
};
inline constexpr size_t kMostEstimatedStations = 1024;

/// Describes a source as a whole.
struct SourceHeader {
    io::Schema schema;
    /// Other schemas in which older nodes of a cache are stored. Loaded nodes are converted to `schema`.
    std::vector<io::Schema> layouts;
    Cube root;                      ///< the root node's cube
    glm::dvec3 min{0.0}, max{0.0};  ///< tight bounds of the points
    uint64_t points = 0;
    double metres_per_unit = 1.0;
    std::vector<io::ScanInfo> scans;
    std::vector<StationColour> station_colours;  ///< sorted by scan and station
    /// Stations of scans that state none, in the order of the scans. At most kMostEstimatedStations.
    std::vector<EstimatedStation> estimated_stations;
    /// Set if holes were looked for.
    std::optional<FillingSection> filling;
    /// Set if a cache's directory is large.
    std::optional<DirectoryPages> directory_pages;
    std::string options;  ///< how the scans were read where it differs from the default: io::options_text
    /// Only some places of the scan are known yet, with gaps between them: the first sample of a compressed
    /// file that is being converted.
    bool has_gaps = false;
};

/// The part of a source that a node belongs to; it defines how the node's key and records are read. A source
/// is one part or joins several, each with its own root, schema, unit and root cube.
struct SourcePart {
    const SourceHeader& header;  ///< in the part's own unit
    uint32_t index = 0;
    double scale = 1.0;       ///< the part's unit in the source's
    uint32_t first_scan = 0;  ///< index of header.scans[0] among the source's scans
};

/// Surfels that nothing measured. They fill holes of a part's scans; they are drawn, and are no points of the
/// source. Grouped by cubes of its root.
struct Filling {
    SourceHeader header;            ///< schema, root and unit of the surfels' records
    std::vector<NodeInfo> nodes;    ///< cubes that contain surfels; not a tree
    std::vector<NodeData> records;  ///< of each node; any prefix is an even subsample
    uint32_t part = 0;
    double scale = 1.0;  ///< the part's unit in the source's
};

/// Identifies what a source contains across runs of the program, for results that are kept about it.
struct SourceIdentity {
    uint64_t content = 0;        ///< equal for equal content
    std::filesystem::path file;  ///< the (first) cache, beside which they may be kept
};

/// Hands out octree nodes: a cache, a COPC file, a growing build, or several sources joined. Thread-safe. The
/// directory is in memory (about 100 bytes a node) or, if it is large, read page by page. Points are loaded
/// node by node.
class NodeSource {
 public:
    virtual ~NodeSource() = default;
    virtual const SourceHeader& header() const = 0;
    /// Parents come before children; a part's nodes are contiguous, its root first. May be empty. Areas are
    /// in the source's unit.
    virtual NodeTable nodes() const = 0;
    /// Fails if a page of the directory could not be read. Its nodes then look empty.
    virtual Result<void> directory_state() const { return {}; }
    virtual std::vector<uint32_t> roots() const {
        return nodes().empty() ? std::vector<uint32_t>{} : std::vector<uint32_t>{0};
    }
    virtual SourcePart part_of(uint32_t) const { return {header()}; }
    virtual uint32_t parts() const { return 1; }
    /// The node's cube, in the source's unit.
    Cube cube(uint32_t node) const {
        const SourcePart part = part_of(node);
        const Cube own = part.header.root.of(nodes()[node].key);
        return {own.min * part.scale, own.size * part.scale};
    }
    /// Bytes of the node's records.
    uint64_t record_bytes(uint32_t node) const {
        return uint64_t{nodes()[node].count} * part_of(node).header.schema.stride;
    }
    /// The most bytes of memory that the directory takes.
    virtual uint64_t directory_bytes() const { return nodes().size() * sizeof(NodeInfo); }
    /// Loads and checks one node; blocks. Errors: unreadable, truncated, checksum.
    virtual Result<NodeData> load(uint32_t node) const = 0;
    /// Returns nothing for sources that have no such file, for example a build that grows.
    virtual std::optional<SourceIdentity> identity() const { return std::nullopt; }
    /// Loads what fills the holes of the parts; nothing for parts without holes. Errors: as of load().
    virtual Result<std::vector<Filling>> fillings() const { return std::vector<Filling>{}; }
};

}  // namespace lucarne::octree
