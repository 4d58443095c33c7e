#pragma once

#include <functional>
#include <map>

#include "octree/convert/chunks/chunk_store.h"
#include "octree/normals/normals.h"

namespace lucarne::octree {

/// What the normals stage found out about each point, in a scratch file beside the chunks.
class SurfaceStore {
 public:
    struct Point {
        glm::vec3 normal{0.0f};  ///< as estimated, before its component's sign
        float area = 0;          ///< in faces of the root cube before it was doubled; 0: unknown
        uint32_t component = 0;
    };
    struct Settings {
        bool normals = true;  ///< false: the input's are kept, only areas are wanted
        uint32_t neighbours = 16;
        NeighbourSearch search = NeighbourSearch::leaf;
        unsigned threads = 0;
        uint64_t memory = 0;
        std::function<Result<void>(uint64_t points)> step;  ///< told of points done; an error of its ends it
    };

    /// Runs the estimator over all chunks. `scans` has the stations, one entry an input.
    static Result<SurfaceStore> estimate(const ChunkStore& chunks, const std::vector<io::ScanInfo>& scans,
                                         ScratchFile file, const Settings& settings);
    /// What `save` wrote down about a store whose scratch file is still there. Errors: a file that does not
    /// hold what was found.
    static Result<SurfaceStore> restore(const ChunkStore& chunks, ScratchFile file,
                                        std::span<const std::byte> record);
    std::vector<std::byte> save() const;
    /// Turns the normals of one orientation component of a chunk around.
    void turn(size_t chunk, uint32_t component);

    /// Points [first, first + count) of a chunk, normals turned the way they shall point.
    Result<std::vector<Point>> load(size_t chunk, uint64_t first, uint64_t count) const;

 private:
    SurfaceStore(ScratchFile file, const ChunkStore& chunks)
        : file_(std::move(file)), sums_(chunks.chunks().size()) {
        for (const auto& chunk : chunks.chunks()) first_.push_back(end_), end_ += chunk.count;
    }
    uint64_t count(size_t chunk) const {
        return (chunk + 1 < first_.size() ? first_[chunk + 1] : end_) - first_[chunk];
    }
    Result<std::vector<Point>> read(size_t chunk, uint64_t first, uint64_t count) const;
    Result<void> keep(size_t chunk, uint64_t count, const ChunkNormals& found);
    void limit_strays();

    ScratchFile file_;
    std::vector<uint64_t> first_;  ///< each chunk's first point
    uint64_t end_ = 0;
    std::vector<uint64_t> sums_;  ///< checksums of the chunks' parts of the file
    OrientationSigns signs_;
    /// Points by area, kAreaBins an octave: the whole cloud's, so that no limit depends on the chunks.
    std::map<int, uint64_t> areas_;
    float most_stray_area_ = 0;  ///< of a point without a plane
};

}  // namespace lucarne::octree
