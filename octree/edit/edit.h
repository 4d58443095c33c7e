#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "io/formats/scan.h"
#include "octree/normals/normals.h"

namespace lucarne::octree {

class Ranks;

struct EditOptions {
    std::filesystem::path cache;
    uint64_t memory = uint64_t{2} << 30;  ///< cap on an edit's memory besides the cache's directory, bytes
    unsigned threads = 0;                 ///< 0: all cores
    std::filesystem::path temp_folder;    ///< for scratch files; empty: the cache's folder
    uint32_t neighbours = 16;             ///< number of neighbours for normals and areas
    NeighbourSearch neighbour_search = NeighbourSearch::leaf;
    /// The processes that append together; null: this one alone. All have the same options, and see the
    /// cache.
    Ranks* ranks = nullptr;
};

/// Which points to delete: those that match every given criterion.
struct Selection {
    std::optional<Box> box;        ///< in the file's unit, including its faces
    std::optional<uint32_t> scan;  ///< index into the cache's scans
};

struct EditReport {
    uint64_t added = 0, removed = 0, points = 0;
    uint64_t dropped = 0;                          ///< dropped among the added points, as in BuildReport
    std::vector<const io::PointSource*> appended;  ///< the scans that were added
    std::vector<io::Contents> inputs;              ///< contents of these scans
    std::vector<std::string> already_in;           ///< paths of scans that the cache already contained
    uint64_t rewritten_points = 0, kept_nodes = 0, nodes = 0, bytes = 0;
};

/// Adds scans to a cache in place. A file that the cache already contains (the same name, size and time of
/// change, and points that were not deleted) is left out with a warning, so the same call can be repeated.
/// Nodes that the new points touch are built again, with all nodes above them, and written after the others.
/// Then one superblock switches to the new state. If the update is killed or fails before that, the cache
/// keeps its old state. Readers that have the cache open keep the old state. Errors besides those of a build:
/// another process is changing the cache; scans in another unit or too far away.
/// Several ranks write the same bytes as one process with the same memory, and all return the error of one of
/// them. Their report is complete at rank 0.
Result<EditReport> append_to_cache(const std::vector<const io::PointSource*>& scans,
                                   const EditOptions& options);

/// Deletes points in the same way. Their bytes stay in the file until `compact_cache`. Errors: no points
/// would be left.
Result<EditReport> delete_from_cache(const Selection& selection, const EditOptions& options);

struct CompactReport {
    uint64_t bytes_before = 0, bytes = 0;
    bool done = true;  ///< false: there was no need
};
/// Writes the cache again without what updates left behind, and replaces the old file when the new one is
/// complete. Readers that have the old one open keep it.
Result<CompactReport> compact_cache(const std::filesystem::path& cache,
                                    const std::filesystem::path& temp_folder);
/// Does the same, but only if less than half of the file is in use. So the file is at most twice as large as
/// necessary, and many updates in a row cost at most a constant factor more.
Result<CompactReport> compact_if_half_unused(const std::filesystem::path& cache,
                                             const std::filesystem::path& temp_folder);

}  // namespace lucarne::octree
