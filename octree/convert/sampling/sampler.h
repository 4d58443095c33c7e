#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/tree/key.h"
#include "octree/tree/prefix_order.h"

namespace lucarne::octree {

/// Thins the points of one cube by Poisson-disk sampling at a decreasing radius. Pass 0 is an even subset in
/// which no two points are nearer than the first radius; every further pass fills the gaps at a smaller
/// radius. So a point's pass tells at which level of detail it appears. Based on: Corsini, Cignoni, Scopigno,
/// "Efficient and flexible sampling with blue noise properties of triangular meshes", 2012 (dart throwing
/// over a given set of points). The nested, bottom-up use is that of Schuetz, Ohrhallinger, Wimmer, "Fast
/// out-of-core octree generation for massive point clouds", 2020. Deterministic: depends only on the points
/// and their order.
class Sampler {
 public:
    /// Drops all points. Points added from now on are in the cube of `node`.
    void start(const NodeKey& node);
    void add(const Place& place);  ///< fastest in Morton order: neighbours are then still in the CPU's cache
    /// Gives every point its pass. `radius` is in cube sizes; it grows until pass 0 has at most `most`
    /// points.
    void run(float radius, size_t most);

    size_t size() const { return points_.size(); }
    std::span<const uint8_t> passes() const { return passes_; }

 private:
    struct Point {
        float x, y, z;  ///< in cube sizes
        uint32_t next;  ///< the next point of the same grid bucket
    };
    void reset_grid(float radius);
    size_t bucket(int32_t x, int32_t y, int32_t z) const;
    void insert(uint32_t point);
    /// Returns the squared distance to some taken point nearer than the radius, infinity if there is none.
    float conflict_around(const Point& point) const;
    float conflict_in(uint32_t first, const Point& point) const;  ///< the same in one bucket
    static float widening(size_t taken, size_t most);
    float wide_enough(float radius, size_t most);
    /// Takes points that fit from `from`, in order, and moves the others to the front of `rest`.
    void take(std::vector<uint32_t>& from, std::vector<uint32_t>& rest, uint8_t pass);

    Place origin_;
    float scale_ = 1;
    std::vector<Point> points_;
    std::vector<uint8_t> passes_;
    std::vector<uint32_t> heads_, taken_, waiting_, thinned_;
    /// For each point the squared distance to a taken one. While the radius is larger, the point need not be
    /// tested again; this saves most searches.
    std::vector<float> blocked_;
    float radius2_ = 0, cells_ = 0;  ///< squared radius; grid cells per cube size
    size_t mask_ = 0;
};

}  // namespace lucarne::octree
