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

/// Caches, COPC files and scans, drawn together. Where all are scans they become one cache.
struct InputOptions {
    std::vector<std::string> paths;
    bool no_cache = false;  ///< scans are converted anew and the cache is gone with the program
    io::ReadOptions read;
    bool required = true;  ///< at least one path
};

/// How a window opens what it shows while it is being converted.
struct Opening {
    uint64_t sample_points = 400'000;  ///< of a scan without a cache
    octree::Sampling sampling;         ///< told while they are read; may end it
    /// A conversion that is stopped, or interrupted otherwise, leaves what the next one goes on from.
    bool resumable = false;
};

/// What can be drawn of the input at once.
struct OpenInput {
    std::shared_ptr<const octree::NodeSource> source;
    std::optional<TemporaryFolder> folder;        ///< of a cache that is not kept; goes after the build
    std::unique_ptr<octree::GrowingBuild> build;  ///< of scans without a cache yet; not begun
};

/// Octrees as they are, or the cache kept of these scans, or a sample of them and their build. Errors: those
/// of the readers.
Result<OpenInput> open_growing(const InputOptions& options, const Opening& opening = {});

/// The same, waiting for a cache that is not there yet. With an octree among them every input is a part of
/// its own, in its own place, unit and schema (octree/stream/joined_source.h). Errors: those of the builder
/// as well.
Result<std::shared_ptr<const octree::NodeSource>> open_input(const InputOptions& options);
/// Of one input.
Result<std::shared_ptr<const octree::NodeSource>> open_input(const std::filesystem::path& path);

/// For titles and reports: "nave.luc" or "nave.luc and 199 more".
std::string inputs_text(const std::vector<std::string>& paths);

}  // namespace lucarne::viewer
