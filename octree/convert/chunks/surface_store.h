#pragma once

#include <functional>
#include <map>

#include "octree/convert/chunks/chunk_store.h"
#include "octree/normals/normals.h"

namespace lucarne::octree {

/// Stores what the normals stage estimates for each point, in a scratch file beside the chunks.
class SurfaceStore {
 public:
    struct Point {
        glm::vec3 normal{0.0f};  ///< as estimated, before its component's sign
        float area = 0;          ///< in faces of the root cube before it was doubled; 0: unknown
        uint32_t component = 0;
        PointEdge edge;
    };
    struct Settings {
        bool normals = true;  ///< false: the input's are kept
        uint32_t neighbours = 16;
        NeighbourSearch search = NeighbourSearch::leaf;
        unsigned threads = 0;
        uint64_t memory = 0;
        /// Which of them saw a point, the chunks tell, or that one saw all of the scan.
        std::vector<EstimatedStation> estimated_stations{};
        /// Called with numbers of finished points; its error ends the stage.
        std::function<Result<void>(uint64_t points)> step;
        /// The ranks that have the chunks; null for this process alone. The estimate is then a meeting.
        Ranks* ranks = nullptr;
        std::filesystem::path folder{};  ///< for a further scratch file of several ranks
    };

    /// Runs the estimator over all chunks. `scans` has the stations, one entry an input.
    static Result<SurfaceStore> estimate(const ChunkStore& chunks, const std::vector<io::ScanInfo>& scans,
                                         ScratchFile file, const Settings& settings);
    /// Restores a store whose scratch file still exists from the record that `save` made. Errors: the file's
    /// contents have changed.
    static Result<SurfaceStore> restore(const ChunkStore& chunks, ScratchFile file,
                                        std::span<const std::byte> record);
    std::vector<std::byte> save() const;
    /// What one of another number of ranks has estimated for its chunks.
    struct Part {
        const ChunkStore* chunks = nullptr;
        const SurfaceStore* surface = nullptr;
    };
    /// Makes the store of chunks that were taken over from the same parts. A meeting.
    static Result<SurfaceStore> take_over(std::span<const Part> parts, const ChunkStore& chunks,
                                          ScratchFile file, const MemoryPlan& memory, Ranks& ranks);
    /// Flips the normals of one orientation component of a chunk.
    void turn(size_t chunk, uint32_t component);
    /// Returns the number of the connected surface that a component of a chunk is a part of; 0: unknown.
    uint32_t surface(size_t chunk, uint32_t component) const;

    /// Returns the points [first, first + count) of a chunk, with their normals oriented (if
    /// Settings::normals).
    Result<std::vector<Point>> load(size_t chunk, uint64_t first, uint64_t count) const;

 private:
    SurfaceStore(ScratchFile file, const ChunkStore& chunks)
        : file_(std::move(file)), sums_(chunks.chunks().size()) {
        for (size_t i = 0; i < chunks.chunks().size(); ++i) {
            first_.push_back(end_);
            if (chunks.own().contains(i)) end_ += chunks.chunks()[i].count;
        }
    }
    uint64_t count(size_t chunk) const {
        return (chunk + 1 < first_.size() ? first_[chunk + 1] : end_) - first_[chunk];
    }
    Result<std::vector<Point>> read(size_t chunk, uint64_t first, uint64_t count) const;
    Result<void> keep(size_t chunk, uint64_t count, const ChunkNormals& found);
    void limit_strays();
    Result<void> estimate_together(const ChunkStore& chunks, const ChunkAccess& access,
                                   const NormalOptions& options,
                                   const std::function<Result<void>(size_t, ChunkNormals&&)>& keep,
                                   const Settings& settings);
    Result<void> sum_areas(Ranks& ranks);

    ScratchFile file_;
    std::vector<uint64_t>
        first_;  ///< index of each chunk's first point; chunks of other ranks have none here
    uint64_t end_ = 0;
    std::vector<uint64_t> sums_;  ///< checksums of the chunks' parts of the file
    OrientationSigns signs_;
    /// Histogram of areas, kAreaBins bins an octave. It covers the whole cloud, so that the limit does not
    /// depend on the chunks.
    std::map<int, uint64_t> areas_;
    float most_stray_area_ = 0;  ///< largest area of a point without a plane; 0: no limit
};

}  // namespace lucarne::octree
