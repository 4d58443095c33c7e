#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "io/files/update_file.h"
#include "octree/cache/file.h"
#include "octree/convert/chunks/chunk_store.h"
#include "octree/convert/chunks/point_stations.h"
#include "octree/edit/edit.h"
#include "octree/stations/station_spans.h"

namespace lucarne::octree {

/// The changes of an update.
struct Change {
    SourceHeader header;  ///< of the new state
    /// Points that are added or removed, by the deepest old node that contains them.
    std::vector<uint64_t> changed;
    /// The new points in the new schema; may be empty. Of several ranks, those that this one reads.
    Pass added;
    ScanPlace first_added;  ///< the first of them
    /// Which of the header's estimated stations saw which parts of the new scans.
    std::vector<StationSpan> spans;
    /// Decides over an old record in the new schema; may be empty.
    std::function<bool(const std::byte*)> removed;
};

/// The cache that is edited; locked while this exists.
struct OpenedCache {
    static Result<OpenedCache> open(const std::filesystem::path& path);
    /// Rank 0 locks the cache for all, and alone writes it. Errors: another rank does not see the same state.
    /// A meeting.
    static Result<OpenedCache> open(const std::filesystem::path& path, Ranks& ranks);

    std::optional<UpdateFile> file;  ///< at rank 0
    std::unique_ptr<CacheFile> cache;
    size_t newest = 0;  ///< index of the superblock of the current state
};

/// Writes the new state after the old one and switches to it. A meeting of the options' ranks.
Result<EditReport> rewrite(OpenedCache opened, const Change& change, const EditOptions& options);

/// Returns the folder for scratch files.
std::filesystem::path scratch_folder(const std::filesystem::path& cache, const std::filesystem::path& given);

}  // namespace lucarne::octree
