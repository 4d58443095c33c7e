#pragma once

#include "octree/convert/chunks/chunk_store.h"
#include "octree/normals/normals.h"
#include "octree/tree/station_ids.h"

namespace lucarne::octree {

/// Shows the chunks and stations of a build to the estimator.
class ChunkPoints final : public ChunkAccess {
 public:
    /// `ranks`: those that have the chunks; null if this process has all.
    ChunkPoints(const ChunkStore& store, const std::vector<io::ScanInfo>& scans,
                std::span<const EstimatedStation> estimated, Ranks* ranks)
        : store_(store), ids_(scans, store.schema(), estimated), ranks_(ranks) {}

    const std::vector<glm::dvec3>& all_stations() const { return ids_.stations(); }

    size_t chunk_count() const override { return store_.chunks().size(); }
    /// A chunk whose points are all at one place appears empty: it has no visible plane, and its points would
    /// be neighbours of everything around.
    uint64_t point_count(size_t chunk) const override {
        const Chunk& found = store_.chunks()[chunk];
        return found.key.level > kMaxLevel ? 0 : found.count;
    }
    Box bounds(size_t chunk) const override {
        const Cube cube = store_.root().of(store_.chunks()[chunk].key);
        return {cube.min, cube.min + glm::dvec3(cube.size)};
    }

    Result<std::vector<glm::dvec3>> positions(size_t chunk) const override;
    Result<std::optional<Part>> far_points(size_t chunk, const Box& box) const override;
    /// Answers a question of another rank's far_points().
    Result<Ranks::Bytes> answer(std::span<const std::byte> question) const;

    Result<std::vector<int32_t>> stations(size_t chunk) const override;

 private:
    int32_t station_of(const std::byte* record) const;
    /// Reads in pieces, because records may be many times as wide as the fields that are used.
    template <typename Use>
    Result<void> for_each_record(size_t chunk, const Use& use) const;

    const ChunkStore& store_;
    StationIds ids_;
    Ranks* ranks_;
};

}  // namespace lucarne::octree
