#pragma once

#include <vector>

#include "octree/convert/chunks/surface_store.h"
#include "octree/normals/splat_surface.h"
#include "octree/tree/point_normals.h"

namespace lucarne::octree {

/// Adds the estimated attributes to the input's schema: areas, lines at edges, if `normals`, normals, and if
/// there are colours, the changes that even them out.
io::Schema with_estimates(io::Schema schema, bool normals);

/// Loads the records of chunks as the cache will store them: the input's, followed by the estimates. In an
/// update the chunks already have the cache's whole schema; then the estimates are written in place: areas
/// and lines of all points, normals of points that have none yet.
class RecordLoader {
 public:
    /// `surface` is null if neither normals nor areas were estimated. `normals`: whether its normals are
    /// wanted. `scans`: the inputs, by their number.
    RecordLoader(const ChunkStore& chunks, const SurfaceStore* surface, bool normals,
                 std::span<const io::ScanInfo> scans);

    const io::Schema& schema() const { return schema_; }
    const Cube& root() const { return chunks_.root(); }
    std::span<const Chunk> chunks() const { return chunks_.chunks(); }
    /// The value of a colour's component at full intensity, of each input; empty if nothing was estimated.
    std::span<const double> whites() const { return whites_; }
    Result<std::vector<std::byte>> load(size_t chunk, uint64_t first, uint64_t count) const;

    Place place(const std::byte* record) const { return root().place(io::position_of(schema_, record)); }
    /// The point's share of the surface, in faces of the root cube before it was doubled; 0 if unknown.
    float area(const std::byte* record) const;

 private:
    /// Returns the edge of a point, seen from the side to which the normal in its record points.
    PointEdge drawn_edge(const SurfaceStore::Point& found, const std::byte* record) const;
    /// Writes the line of a point whose normal and area have been written.
    void put_edge(const SurfaceStore::Point& found, std::byte* record) const;

    const ChunkStore& chunks_;
    const SurfaceStore* surface_;
    io::Schema schema_;
    std::vector<double> whites_;
    SplatSurface splats_;
    PointNormals drawn_normals_;
    const io::Attribute *normal_ = nullptr, *area_ = nullptr, *edge_ = nullptr;
};

}  // namespace lucarne::octree
