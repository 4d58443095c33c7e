#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/core/error.h"
#include "io/files/temporary_folder.h"
#include "io/formats/scan.h"
#include "octree/growing/growing_build.h"
#include "octree/tree/source.h"

namespace lucarne::viewer {

/// Inputs that are drawn together: caches, COPC files and scans. If all are scans, they become one cache.
struct InputOptions {
    std::vector<std::string> paths;
    bool no_cache = false;  ///< convert scans again; the cache is removed when the program ends
    io::ReadOptions read;
    bool required = true;  ///< at least one path must be given
};

/// How a window opens scans that it shows while they are converted.
struct Opening {
    uint64_t sample_points = 400'000;  ///< of scans without a cache
    /// Points of the first source, and how many points may be read for it
    /// (octree::GrowingOptions::first_points).
    uint64_t first_points = 0, first_read = 0;
    uint64_t read_points = 0;   ///< kept of the first pass of the conversion (octree::GrowingOptions)
    double patience = 0;        ///< for which the conversion waits for pictures of these, s (likewise)
    octree::Sampling sampling;  ///< is told of the progress of sampling, and may end it
    /// An interrupted conversion keeps its finished stages, and the next conversion continues from them.
    bool resumable = false;
};

/// What can be drawn at once, and the build that is still to run.
struct OpenInput {
    std::shared_ptr<const octree::NodeSource> source;
    std::optional<TemporaryFolder> folder;        ///< of a cache that is not kept; removed after the build
    std::unique_ptr<octree::GrowingBuild> build;  ///< for scans without a cache; not started yet
    std::filesystem::path cache;                  ///< the file that the build writes; empty: it is not kept
};

/// Opens octrees as they are, else the kept cache of the scans, else a sample of the scans together with
/// their build. Errors: those of the readers.
Result<OpenInput> open_growing(const InputOptions& options, const Opening& opening = {});

/// Opens the inputs, and converts scans first if they have no cache. If one input is an octree, every input
/// becomes a part of the source with its own placement, unit and schema (octree/stream/joined_source.h).
/// Errors: those of the readers and of the builder.
Result<std::shared_ptr<const octree::NodeSource>> open_input(const InputOptions& options);
/// Opens one input.
Result<std::shared_ptr<const octree::NodeSource>> open_input(const std::filesystem::path& path);

/// Returns a text for titles and reports: "nave.luc" or "nave.luc and 199 more".
std::string inputs_text(const std::vector<std::string>& paths);

}  // namespace lucarne::viewer
