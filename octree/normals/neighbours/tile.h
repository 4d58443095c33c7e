#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace lucarne::octree {

/// Points in double precision, one array per coordinate.
struct PointArrays {
    std::vector<double> x, y, z;

    size_t size() const { return x.size(); }
    glm::dvec3 operator[](size_t i) const { return {x[i], y[i], z[i]}; }
    void push_back(const glm::dvec3& p) {
        x.push_back(p.x);
        y.push_back(p.y);
        z.push_back(p.z);
    }
    void reserve(size_t count);
    void clear();
    void release();  ///< frees the memory
};

/// The number of floats that the vector loops below process at a time. They read and write up to the next
/// multiple.
inline constexpr size_t kLanes = 8;

/// The points around a few queries, relative to an origin among them. A tile is small enough for the CPU's
/// first-level cache and for float precision. The arrays are longer than `count`; after pad() they hold zeros
/// up to the next multiple of kLanes.
struct Tile {
    glm::dvec3 origin{0.0};
    size_t count = 0;
    std::vector<float> x, y, z;
    std::vector<uint32_t> index;            ///< indices of the points
    std::vector<uint32_t> nodes, children;  ///< scratch memory of PointIndex::gather

    void clear(const glm::dvec3& new_origin);
    void make_room(size_t more);  ///< for `more` points beyond `count`, and kLanes
    void pad();
    /// Appends those of points [first, last) whose distance from the box low .. high (relative to the origin)
    /// is at most the root of `limit2`. Their index is the point's plus `offset`.
    void append(const PointArrays& points, size_t first, size_t last, uint32_t offset, const glm::vec3& low,
                const glm::vec3& high, float limit2);
};

/// Points around one of them, as offsets from it. After pad() the arrays hold zeros up to the next multiple
/// of kLanes.
struct Patch {
    size_t count = 0;
    std::vector<float> x, y, z, distance2;
    std::vector<uint32_t> index;

    void clear() { count = 0; }
    void make_room(size_t points);
    void push_back(const glm::vec3& offset, uint32_t point);  ///< call make_room() first
    void pad();
    glm::vec3 offset(size_t i) const { return {x[i], y[i], z[i]}; }

    /// Replaces the patch by the tile's points within the root of `limit2` of `centre` (relative to the
    /// tile's origin).
    void take_within(const Tile& tile, const glm::vec3& centre, float limit2);
    /// Replaces the patch by the `most` nearest points of another patch, nearest first; among points at equal
    /// distance the first ones.
    void take_nearest(Patch& from, size_t most);
};

/// Sums over points: their number, their coordinates, and the products xx, yy, zz, xy, xz, yz.
struct Moments {
    size_t count = 0;
    std::array<float, 3> sum{};
    std::array<float, 6> products{};
};
Moments moments_of(const Patch& patch);
/// Sums over the points whose height over a plane through the centre is within `limit` of `level`, and over
/// the centre itself; `others`: over all other points.
struct Slab {
    glm::vec3 normal;
    float level, limit;
};
Moments moments_of_slab(const Patch& patch, const Slab& slab, bool others);
/// Returns the number of points in a slab.
size_t count_in_slab(const Patch& patch, const Slab& slab);
/// Returns how many points of a patch are nearer than the root of `limit2` to each of eight points first,
/// first + step, ..., themselves included. Points beyond the last one have none.
std::array<int32_t, kLanes> counts_near(const Patch& patch, size_t first, size_t step, float limit2);

/// Computes the heights over the plane through the centre, padded as the patch. Returns the lowest and the
/// highest.
struct Range {
    float low, high;
};
Range heights_over(const Patch& patch, const glm::vec3& normal, std::vector<float>& heights);

/// The gap between heights at `middle`: the highest height below it, the lowest not below it, and how many
/// are below. `heights` are padded with zeros up to a multiple of kLanes.
struct Gap {
    float below, above;
    size_t lower;
};
Gap gap_at(const std::vector<float>& heights, size_t count, const Range& range, float middle);

/// Eight boxes, one array per side. Their sides are rounded outward to floats.
inline constexpr size_t kBoxes = 8;
struct Boxes {
    std::array<std::array<float, kBoxes>, 3> low, high;
};
/// Computes the squared distances of boxes from a box, up to rounding.
void distances_of(const Boxes& boxes, const glm::vec3& low, const glm::vec3& high,
                  std::array<float, kBoxes>& distance2);
/// A box, and how far from it boxes are looked for.
struct Vicinity {
    glm::vec3 low, high;
    float limit2;
};
/// Writes the children of `nodes` that are in a vicinity to `children`, in the same order: child i of a node
/// n has the number 8 n + i, and the box i of level[n]. `children` has room for eight a node. Returns their
/// number.
size_t children_within(const std::vector<Boxes>& level, const uint32_t* nodes, size_t count,
                       const Vicinity& vicinity, uint32_t* children);

/// Directions about a point in a plane. The first is turned by .2113 of a step, a root of the second
/// Bernoulli polynomial. With this offset a sum over directions integrates functions with kinks at multiples
/// of 45 degrees (cells of a regular grid) to second order.
inline constexpr size_t kDirections = 32;
struct Directions {
    std::array<float, kDirections> x, y;
};
const Directions& directions();

/// A point's normal and two axes in its tangent plane: unit vectors at right angles.
struct TangentFrame {
    glm::vec3 normal{0.0f}, x{0.0f}, y{0.0f};
};

/// A cell described by its reach: nearness[d] is 1 / reach in direction d. A neighbour at (u, v) in the plane
/// limits the reach to (u^2 + v^2) / (2 (u cos + v sin)).
using Nearness = std::array<float, kDirections>;

/// Cuts the cell by the neighbours whose height is in the layer, as if they were in the plane. `others`: and
/// by all others, half-way to where they are in space. Neighbours nearer to the point, in the
/// plane, than the root of `coincident2` cut nothing; returns their number. `heights` are those of
/// heights_over().
size_t cut_by_layer(const Patch& patch, const std::vector<float>& heights, const Range& layer,
                    const TangentFrame& frame, float coincident2, bool others, Nearness& nearness);

/// Selects the points of a tile that continue a surface: those within the root of `limit2` of `centre` whose
/// squared height over the plane is at most `slope2` of their squared distance in it.
struct Slope {
    glm::vec3 centre;  ///< relative to the tile's origin
    float limit2, slope2, coincident2;
};
/// Cuts the cell by the points that `slope` selects. Returns the nearest of them that is farther than the
/// root of `beyond2`, or the tile's count.
size_t cut_by_slope(const Tile& tile, const Slope& slope, const TangentFrame& frame, float beyond2,
                    Nearness& nearness);

/// Computes the squared distances of all neighbours of a patch, that is of all points but the first, to their
/// second nearest among each other.
void second_nearest(const Patch& patch, std::vector<float>& distance2);

/// A run of kRun sectors of kSectors about the centre of a patch: 112 degrees. A corner of three planes
/// leaves 90.
inline constexpr size_t kSectors = 16, kRun = 5;
struct SectorRun {
    Moments moments;  ///< of the points in the run, without the centre
    /// How badly a plane fits to them and to the centre: the variance of the points' heights plus the squared
    /// height of the centre.
    float misfit = 0;
};
/// Returns the run that fits to a plane best; no points if there are fewer than `least` in every run.
SectorRun flattest_run(const Patch& patch, const TangentFrame& frame, size_t least);

/// Returns the nearest point of a patch in each quarter of the plane that is low enough over it, without the
/// point itself; the patch's count where there is none.
std::array<size_t, 4> nearest_by_quarter(const Patch& patch, const TangentFrame& frame, float slope2);

float least_of(const Nearness& nearness);
/// Returns the mean square of the distances 1 / nearness that are below `radius`; 0 if there are none.
float mean_square_within(const Nearness& nearness, float radius);

}  // namespace lucarne::octree
