#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include <glm/vec3.hpp>

#include "io/files/byte_source.h"
#include "io/formats/turned.h"
#include "io/lattice.h"
#include "io/points.h"

namespace lucarne::io {

/// How a mesh becomes points. `spacing` takes precedence over `samples`. If neither is set, the mesh's size
/// and vertices decide.
struct MeshOptions {
    double spacing = 0;     ///< mean distance of samples, metres
    uint64_t samples = 0;   ///< approximate number
    bool vertices = false;  ///< read the vertices as points and ignore the faces
};

/// Options for reading, where the user knows better than the file.
struct ReadOptions {
    /// The columns of a text file, "x,y,z,-,intensity:f32,r,g,b". If empty, they are guessed.
    std::string columns;
    bool quiet = false;  ///< do not report guesses again: the file was opened before
    MeshOptions mesh;
    /// Reads what can be read of a damaged or truncated file. The `losses` of its info and readers list the
    /// rest.
    bool salvage = false;
    /// Metres per unit of length of the file. If unset, the file's own unit counts, or metres where it states
    /// none.
    std::optional<double> metres_per_unit;
    UpAxis up = UpAxis::z;  ///< of the file; the scan is turned so that z points up
};
/// Returns the options that change the points as text; empty if all have their default. A cache keeps this
/// text, so that a cache made with other options is not used by mistake.
std::string options_text(const ReadOptions& options);

/// Opens a scan file. The content tells the format. The name tells it where the content does not, and among
/// text formats whose rows look the same. Reads only the header, and a sample of a text file. Errors:
/// unreadable, empty, unknown or contradictory files (ErrorKind::input_rejected).
Result<std::unique_ptr<PointSource>> open_scan(const std::filesystem::path& path,
                                               const ReadOptions& options = {});
/// The same for bytes that are open already. Their path gives the name.
Result<std::unique_ptr<PointSource>> open_scan(std::shared_ptr<const ByteSource> file,
                                               const ReadOptions& options = {});

/// What one pass over all points finds out.
struct Contents {
    uint64_t points = 0;
    glm::dvec3 min{0.0}, max{0.0};  ///< valid only if there are points
    uint32_t color_bits = 0;        ///< that the colours of all points need: may be more than a sample did
    Losses losses;                  ///< including those of the info
};
/// Makes that pass. Calls `progress` with the number of further points seen.
Result<Contents> survey(const PointSource& scan, const std::function<void(uint64_t)>& progress = {});

/// Returns the error of a file that was rejected with these options, with advice added: how many points
/// --salvage would read. Finds the number out by reading them.
Error with_salvage_advice(Error error, const std::filesystem::path& path, const ReadOptions& options);

struct WriteOptions {
    bool overwrite = false;
    uint64_t expected_points = 0;  ///< a hint; 0 if unknown
    /// The box of the points, if known. A LAS writer uses it to pick the finest scale for float positions.
    std::optional<PositionBox> bounds{};
    /// The lattice on which all float positions lie, if known, as for those of several LAS files.
    std::optional<Lattice> lattice{};
    /// Passes all records that are to be written to `visit`, until it returns false. It serves a writer that
    /// must know more about them than their box. Empty if the records can be produced only once.
    std::function<Result<void>(const std::function<bool(std::span<const std::byte>)>& visit)> preview{};
};

/// Creates a writer for the format that `path`'s extension names (.las, .laz, .ply, .pcd, .csv, .txt, .xyz).
/// The file appears when `finish` succeeds. If the source had the same format, `info.notes` restores its
/// header (version, point format, VLRs, types).
Result<std::unique_ptr<PointWriter>> create_scan(const std::filesystem::path& path, const Schema& schema,
                                                 const ScanInfo& info, const WriteOptions& options);

}  // namespace lucarne::io
