#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/points.h"
#include "octree/tree/source.h"

namespace lucarne::viewer {

/// Where the cache of scans that were opened as they are is kept for the next time: beside the first of them
/// (`a.las.luc`; of several `a.las+2-<hash>.luc`), or where that folder cannot be written, in the user's
/// cache folder
/// ($XDG_CACHE_HOME/lucarne, ~/.cache/lucarne) under a name that follows from their whole paths.
class KeptCache {
 public:
    using Scans = std::vector<io::ScanInfo>;
    /// `scans`: of the inputs, with their paths, sizes and times. `options`: how they are read
    /// (io::options_text).
    explicit KeptCache(const Scans& scans, std::string options = {});

    /// The cache, if one is kept that was made from the scans as they are now, read as they are now: the same
    /// files, sizes, times and options.
    std::shared_ptr<const octree::NodeSource> find() const;
    /// The file to write: the first place that can be written and holds nothing but, at most, an older cache
    /// of the same scans. Makes the cache folder. Empty: there is no such place.
    std::optional<std::filesystem::path> place() const;

 private:
    bool made_of(const octree::NodeSource& cache, bool same_state) const;

    Scans scans_;
    std::string options_;
    std::filesystem::path beside_, in_folder_;  ///< the latter is empty where the user has no cache folder
};

}  // namespace lucarne::viewer
