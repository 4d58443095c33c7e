#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/formats/scan.h"
#include "io/points.h"
#include "octree/convert/chunks/workspace.h"
#include "octree/normals/normals.h"

namespace lucarne::octree {

enum class NormalsMode {
    automatic,  ///< keep the inputs' own; estimate those of points that have none
    keep,       ///< keep the inputs' own; only areas are estimated
    estimate,   ///< estimate; the inputs' own stay as an attribute of another name
    none        ///< neither normals nor areas
};

class BuildListener;
class Ranks;

struct BuildOptions {
    std::vector<const io::PointSource*> inputs;
    std::filesystem::path output;
    NormalsMode normals = NormalsMode::automatic;
    uint64_t memory = uint64_t{2} << 30;  ///< cap on the build's memory, bytes
    unsigned threads = 0;                 ///< 0: all cores
    std::filesystem::path temp_folder;    ///< for scratch files; empty: the output's folder
    bool overwrite = false;
    Resume resume = Resume::never;
    std::string read_options;  ///< how the inputs were opened (io::options_text); stored in the cache
    uint32_t neighbours = 16;  ///< number of neighbours for normals and areas
    NeighbourSearch neighbour_search = NeighbourSearch::leaf;
    bool fill = true;  ///< look for holes, and store surfels that fill them (octree/holes)
    /// The processes that build the cache together; null: this one alone. All have the same options. They go
    /// on with what any number of processes left, if all its parts are on machines that take part.
    Ranks* ranks = nullptr;
    BuildListener* listener = nullptr;  ///< told about the progress (build_listener.h); outlives the build
};

struct StageTime {
    std::string name;
    double wall_seconds = 0, cpu_seconds = 0;  ///< wall 0: the stage ran within the previous one
};

struct BuildReport {
    uint64_t points = 0;
    /// Points that were read but left out: invalid ones and those with a coordinate that is not a number.
    uint64_t dropped = 0;
    uint64_t estimated_normals = 0;  ///< points whose normal was estimated because their input gave none
    std::vector<io::Contents> inputs;
    uint64_t nodes = 0, chunks = 0, bytes = 0;
    uint64_t estimated_stations = 0;  ///< of inputs that state none
    uint64_t filled = 0;              ///< synthetic surfels in holes
    std::vector<StageTime> stages;    ///< CPU times of all ranks, wall times of this one
    uint64_t exchanged = 0;           ///< bytes that ranks sent to others
};

/// Builds a cache from scans. Scans them, sorts the points into chunks, estimates normals, then builds chunk
/// by chunk while the levels above are assembled. The file is the same for any number of threads and any
/// memory cap. Errors: unreadable inputs, no points, an output that exists or cannot be written, a full disk.
/// A failed build leaves nothing behind, except what `resume` asks for. A resumed build gives the same bytes.
/// So does one of several ranks, which all return the error of one of them. Their report is complete at rank
/// 0.
Result<BuildReport> build_cache(const BuildOptions& options);

/// Returns whether a resumable build of the same output is running, in this process or another one of this
/// machine.
bool is_being_built(const BuildOptions& options);

}  // namespace lucarne::octree
