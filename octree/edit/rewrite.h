#pragma once

#include <functional>
#include <vector>

#include "io/files/update_file.h"
#include "octree/cache/file.h"
#include "octree/convert/chunks/chunk_store.h"
#include "octree/edit/edit.h"

namespace lucarne::octree {

/// What an update changes.
struct Change {
    SourceHeader header;            ///< of the new state
    std::vector<uint64_t> changed;  ///< points that come or go, by the deepest old node they are in
    Pass added;                     ///< the new points in the new schema; may be empty
    std::function<bool(const std::byte*)> removed;  ///< of an old record in the new schema; may be empty
};

/// The cache that is edited, locked until it goes.
struct OpenedCache {
    static Result<OpenedCache> open(const std::filesystem::path& path);

    UpdateFile file;
    std::unique_ptr<CacheFile> cache;
    size_t newest = 0;  ///< which superblock the state is of
};

/// Writes the new state behind the old one and switches.
Result<EditReport> rewrite(OpenedCache opened, const Change& change, const EditOptions& options);

/// The folder for scratch files.
std::filesystem::path scratch_folder(const std::filesystem::path& cache, const std::filesystem::path& given);

}  // namespace lucarne::octree
