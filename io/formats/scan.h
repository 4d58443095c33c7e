#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>

#include <glm/vec3.hpp>

#include "io/points.h"

namespace lucarne::io {

/// How a mesh becomes points. `spacing` goes before `samples`; neither: by the mesh's size and vertices.
struct MeshOptions {
    double spacing = 0;        ///< mean distance of samples, metres
    uint64_t samples = 0;      ///< about so many
    bool vertices = false;     ///< its vertices are the points, and its faces are nothing
};

/// What a user knows better than the file.
struct ReadOptions {
    /// Of a text file: what its columns are, "x,y,z,-,intensity:f32,r,g,b"; empty: they are guessed.
    std::string columns;
    bool quiet = false;  ///< guesses are not said again: the file was open before
    MeshOptions mesh;
};

/// Opens a scan file; its format is told by its content, by its name only among text files whose rows look the
/// same. Reads the header only, and a sample of a text file.
/// Errors: unreadable, empty, unknown or contradictory files (ErrorKind::input_rejected).
Result<std::unique_ptr<PointSource>> open_scan(const std::filesystem::path& path,
                                               const ReadOptions& options = {});

struct WriteOptions {
    bool overwrite = false;
    uint64_t expected_points = 0;  ///< a hint; 0 where unknown
    /// The box of the points, where known: lets a LAS writer pick the finest scale for float positions.
    std::optional<std::array<glm::dvec3, 2>> bounds;
};

/// A writer for the format that `path`'s extension names (.las, .laz, .ply, .pcd); the file appears when `finish`
/// succeeds. `info.details` of a source of the same format restores its header (version, point format, VLRs,
/// types).
Result<std::unique_ptr<PointWriter>> create_scan(const std::filesystem::path& path, const Schema& schema,
                                                 const ScanInfo& info, const WriteOptions& options);

}  // namespace lucarne::io
