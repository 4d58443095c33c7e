#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "io/formats/scan.h"
#include "octree/normals/normals.h"

namespace lucarne::octree {

struct EditOptions {
    std::filesystem::path cache;
    uint64_t memory = uint64_t{2} << 30;  ///< cap on what an edit holds besides the cache's directory, bytes
    unsigned threads = 0;                 ///< 0: all cores
    std::filesystem::path temp_folder;    ///< for scratch files; empty: the cache's folder
    uint32_t neighbours = 16;             ///< for normals and areas
    NeighbourSearch neighbour_search = NeighbourSearch::leaf;
};

/// Which points to delete: those for which all that is given holds.
struct Selection {
    std::optional<Box> box;        ///< in the file's unit, its faces included
    std::optional<uint16_t> scan;  ///< index into the cache's scans
};

struct EditReport {
    uint64_t added = 0, removed = 0, points = 0;
    uint64_t dropped = 0;                          ///< of what was added, as in BuildReport
    std::vector<const io::PointSource*> appended;  ///< the scans that were added
    std::vector<io::Contents> inputs;              ///< of these
    std::vector<std::string> already_in;           ///< paths of scans that the cache held before
    uint64_t rewritten_points = 0, kept_nodes = 0, nodes = 0, bytes = 0;
};

/// Adds scans to a cache in place. A file that the cache holds already (the same name, size and time of
/// change, and points that were not deleted) is left out with a warning, so that the same call can be made
/// again. Nodes that the new points touch are built again, with all nodes above them, and written behind the
/// others; then one superblock switches. Killed or failed at any moment before, the cache is the old one;
/// readers that have it open keep the old state. Errors besides those of a build: somebody else is changing
/// the cache; scans of another unit or too far away.
Result<EditReport> append_to_cache(const std::vector<const io::PointSource*>& scans,
                                   const EditOptions& options);

/// Deletes points in the same way. Their bytes stay in the file until `compact_cache`. Errors: nothing would
/// be left.
Result<EditReport> delete_from_cache(const Selection& selection, const EditOptions& options);

struct CompactReport {
    uint64_t bytes_before = 0, bytes = 0;
    bool done = true;  ///< false: there was no need
};
/// Writes the cache anew without what updates left behind, and puts it in place of the old one when it is
/// whole. Readers that have the old one open keep it.
Result<CompactReport> compact_cache(const std::filesystem::path& cache,
                                    const std::filesystem::path& temp_folder);
/// The same, but only where less than half of the file is in use: the file is at most twice what it needs,
/// and many updates in a row cost at most a constant factor more.
Result<CompactReport> compact_if_half_unused(const std::filesystem::path& cache,
                                             const std::filesystem::path& temp_folder);

}  // namespace lucarne::octree
