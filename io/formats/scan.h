#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include <glm/vec3.hpp>

#include "io/files/byte_source.h"
#include "io/lattice.h"
#include "io/points.h"

namespace lucarne::io {

/// How a mesh becomes points. `spacing` goes before `samples`; neither: by the mesh's size and vertices.
struct MeshOptions {
    double spacing = 0;     ///< mean distance of samples, metres
    uint64_t samples = 0;   ///< about so many
    bool vertices = false;  ///< its vertices are the points, and its faces are nothing
};

/// What a user knows better than the file.
struct ReadOptions {
    /// Of a text file: what its columns are, "x,y,z,-,intensity:f32,r,g,b"; empty: they are guessed.
    std::string columns;
    bool quiet = false;  ///< guesses are not said again: the file was open before
    MeshOptions mesh;
    /// What can be read of a damaged or truncated file is; `losses` of its info and readers say what is not.
    bool salvage = false;
    /// How many metres a length of 1 in the file is; none: what the file says, metres where it says nothing.
    std::optional<double> metres_per_unit;
};
/// What of the options changes the points; empty where all are as usual. Kept with a cache, so that one that
/// was made with others is not taken for it.
std::string options_text(const ReadOptions& options);

/// Opens a scan file; its format is told by its content; by its name where that says nothing, and among text
/// files whose rows look the same. Reads the header only, and a sample of a text file.
/// Errors: unreadable, empty, unknown or contradictory files (ErrorKind::input_rejected).
Result<std::unique_ptr<PointSource>> open_scan(const std::filesystem::path& path,
                                               const ReadOptions& options = {});
/// The same of bytes that are open already, and by the name of their path.
Result<std::unique_ptr<PointSource>> open_scan(std::shared_ptr<const ByteSource> file,
                                               const ReadOptions& options = {});

/// What one pass over all points tells.
struct Contents {
    uint64_t points = 0;
    glm::dvec3 min{0.0}, max{0.0};  ///< where there are points
    Losses losses;                  ///< those of the info as well
};
/// Makes that pass. `progress` is told how many more points were seen.
Result<Contents> survey(const PointSource& scan, const std::function<void(uint64_t)>& progress = {});

/// The error of a file that was rejected with these options, and what to do: how many points --salvage would
/// read, which is found out by reading it.
Error with_salvage_advice(Error error, const std::filesystem::path& path, const ReadOptions& options);

struct WriteOptions {
    bool overwrite = false;
    uint64_t expected_points = 0;  ///< a hint; 0 where unknown
    /// The box of the points, where known: lets a LAS writer pick the finest scale for float positions.
    std::optional<PositionBox> bounds{};
    /// Where all float positions are known to stand, as those of several LAS files do.
    std::optional<Lattice> lattice{};
    /// Shows all records that are to be written, until `visit` is false: for a writer that needs to know more
    /// of them than their box. Empty where they can be had only once.
    std::function<Result<void>(const std::function<bool(std::span<const std::byte>)>& visit)> preview{};
};

/// A writer for the format that `path`'s extension names (.las, .laz, .ply, .pcd, .csv, .txt, .xyz); the file
/// appears when `finish` succeeds. `info.notes` of a source of the same format restores its header (version,
/// point format, VLRs, types).
Result<std::unique_ptr<PointWriter>> create_scan(const std::filesystem::path& path, const Schema& schema,
                                                 const ScanInfo& info, const WriteOptions& options);

}  // namespace lucarne::io
