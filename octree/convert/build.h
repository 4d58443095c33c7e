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
    automatic,  ///< keep where every input has them, else estimate
    keep,       ///< the inputs' own; areas are estimated
    estimate,   ///< in place of the inputs' own, which stay as an attribute of another name
    none        ///< neither normals nor areas
};

class BuildListener;

struct BuildOptions {
    std::vector<const io::PointSource*> inputs;
    std::filesystem::path output;
    NormalsMode normals = NormalsMode::automatic;
    uint64_t memory = uint64_t{2} << 30;  ///< cap on what the build holds, bytes
    unsigned threads = 0;                 ///< 0: all cores
    std::filesystem::path temp_folder;    ///< for scratch files; empty: the output's folder
    bool overwrite = false;
    Resume resume = Resume::never;
    std::string read_options;  ///< how the inputs were opened (io::options_text), to be kept with the cache
    uint32_t neighbours = 16;  ///< for normals and areas
    NeighbourSearch neighbour_search = NeighbourSearch::leaf;
    BuildListener* listener = nullptr;  ///< told how it goes on (build_listener.h); outlives the build
};

struct StageTime {
    std::string name;
    double wall_seconds = 0, cpu_seconds = 0;  ///< wall 0: ran within the stage before
};

struct BuildReport {
    uint64_t points = 0;
    /// Points that were read and left out: those without a number for a coordinate, invalid ones.
    uint64_t dropped = 0;
    std::vector<io::Contents> inputs;
    uint64_t nodes = 0, chunks = 0, bytes = 0;
    std::vector<StageTime> stages;
};

/// Builds a cache from scans: scan, chunk, normals, then build chunk by chunk while the levels above are put
/// together. The file is the same for any number of threads and any memory cap. Errors: unreadable inputs, no
/// points, an output that exists or cannot be written, a full disk; nothing is left behind, but for what
/// `resume` asks for. A resumed build gives the same bytes.
Result<BuildReport> build_cache(const BuildOptions& options);

}  // namespace lucarne::octree
