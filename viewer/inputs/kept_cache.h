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

/// The cache of directly opened scans that is kept for the next time. It is placed beside the scan
/// (`a.las.luc`); that of several scans beside the folder that contains them all (`tiles-<hash>.luc`), since
/// among them it would be taken for one of them. If that place cannot be written, it is placed in the user's
/// cache folder ($XDG_CACHE_HOME/lucarne, ~/.cache/lucarne) under a name derived from the scans'
/// full paths.
class KeptCache {
 public:
    using Scans = std::vector<io::ScanInfo>;
    /// `scans`: the inputs with their paths, sizes and times. `options`: how they are read
    /// (io::options_text).
    explicit KeptCache(const Scans& scans, std::string options = {});

    /// Returns the kept cache if it was made from the same files with the same sizes, times and reading
    /// options; else null.
    std::shared_ptr<const octree::NodeSource> find() const;
    /// Returns the file to write: the first writable place that is free or contains an older cache of the
    /// same scans, on a disk with room for `bytes`. Makes the cache folder. Returns nothing if there is no
    /// such place.
    std::optional<std::filesystem::path> place(uint64_t bytes) const;
    /// Returns a rough upper limit of what a conversion writes, bytes: the cache and its scratch files.
    uint64_t bytes_needed() const;

 private:
    bool made_of(const octree::NodeSource& cache, bool same_state) const;

    Scans scans_;
    std::string options_;
    std::filesystem::path beside_, in_folder_;  ///< the latter is empty if the user has no cache folder
    /// Where earlier versions placed the cache of several scans; empty for one. It is read, not written.
    std::filesystem::path among_;
};

}  // namespace lucarne::viewer
