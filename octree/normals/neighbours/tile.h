#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

namespace lucarne::octree {

/// Points in double precision, one array a coordinate.
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
    void release();  ///< gives the memory back
};

/// All vector loops below go over so many floats at a time, and read and write up to the next multiple.
inline constexpr size_t kLanes = 8;

/// The points around a few queries, relative to an origin among them: small enough to stay in the first
/// cache, and floats are exact enough there. The arrays are longer than `count`, and hold zeros up to the
/// next multiple of kLanes once pad() was called.
struct Tile {
    glm::dvec3 origin{0.0};
    size_t count = 0;
    std::vector<float> x, y, z;
    std::vector<uint32_t> index;  ///< which points they are

    void clear(const glm::dvec3& new_origin);
    void make_room(size_t more);  ///< for so many points beyond `count`, and kLanes
    void pad();
    /// Appends those of points [first, last) whose distance from the box low .. high (relative to the origin)
    /// is at most the root of `limit2`; their index is the point's plus `offset`.
    void append(const PointArrays& points, size_t first, size_t last, uint32_t offset, const glm::vec3& low,
                const glm::vec3& high, float limit2);
};

/// Points around one of them as offsets from it; zeros up to the next multiple of kLanes.
struct Patch {
    size_t count = 0;
    std::vector<float> x, y, z, distance2;
    std::vector<uint32_t> index;

    void clear() { count = 0; }
    void make_room(size_t points);
    void push_back(const glm::vec3& offset, uint32_t point);  ///< make_room() first
    void pad();
    glm::vec3 offset(size_t i) const { return {x[i], y[i], z[i]}; }

    /// Becomes the tile's points within the root of `limit2` of `centre` (relative to the tile's origin).
    void take_within(const Tile& tile, const glm::vec3& centre, float limit2);
    /// Becomes the `most` nearest of another patch, nearest first; of those at one distance, the first.
    void take_nearest(Patch& from, size_t most);
};

/// Sums over points: how many, their coordinates, and the products xx, yy, zz, xy, xz, yz.
struct Moments {
    size_t count = 0;
    std::array<float, 3> sum{};
    std::array<float, 6> products{};
};
Moments moments_of(const Patch& patch);

/// Heights over the plane through the centre, padded as the patch; returns the lowest and the highest.
struct Range {
    float low, high;
};
Range heights_over(const Patch& patch, const glm::vec3& normal, std::vector<float>& heights);

/// What is next to `middle`: the highest below it, the lowest not below it, and how many are below. `heights`
/// are padded with zeros up to a multiple of kLanes.
struct Gap {
    float below, above;
    size_t lower;
};
Gap gap_at(const std::vector<float>& heights, size_t count, const Range& range, float middle);

/// Eight boxes, one array a side.
inline constexpr size_t kBoxes = 8;
struct Boxes {
    std::array<std::array<double, kBoxes>, 3> low, high;
};
/// The squared distances of boxes from a box.
void distances_of(const Boxes& boxes, const glm::dvec3& low, const glm::dvec3& high,
                  std::array<double, kBoxes>& distance2);

/// Directions about a point in a plane. The first is turned by .2113 of a step, which is where a sum over
/// directions integrates a function with kinks at multiples of 45 degrees (cells of a regular grid) to second
/// order (the root of the second Bernoulli polynomial).
inline constexpr size_t kDirections = 32;
struct Directions {
    std::array<float, kDirections> x, y;
};
const Directions& directions();

/// Two axes in the plane through a point, and its normal: all unit and at right angles.
struct TangentFrame {
    glm::vec3 normal{0.0f}, x{0.0f}, y{0.0f};
};

/// A cell by its reach: nearness[d] is one over how far it goes in a direction. A neighbour at (u, v) in the
/// plane cuts it at 2 (u cos + v sin) / (u^2 + v^2).
using Nearness = std::array<float, kDirections>;

/// Cuts the cell by the neighbours whose height is in the layer; returns how many of these are nearer to the
/// point, in the plane, than the root of `coincident2`, and cut nothing. `heights` as heights_over() gives.
size_t cut_by_layer(const Patch& patch, const std::vector<float>& heights, const Range& layer,
                    const TangentFrame& frame, float coincident2, Nearness& nearness);

/// What of a tile goes on with a surface: points within the root of `limit2` of `centre` whose height over
/// the plane, squared, is at most `slope2` of their squared distance in it.
struct Slope {
    glm::vec3 centre;  ///< relative to the tile's origin
    float limit2, slope2, coincident2;
};
/// Cuts the cell by these; returns the nearest farther than the root of `beyond2`, or the tile's count.
size_t cut_by_slope(const Tile& tile, const Slope& slope, const TangentFrame& frame, float beyond2,
                    Nearness& nearness);

/// The nearest points of a patch in each quarter of the plane that are low enough over it, the point itself
/// left out; the patch's count where there is none.
std::array<size_t, 4> nearest_by_quarter(const Patch& patch, const TangentFrame& frame, float slope2);

float least_of(const Nearness& nearness);
/// Of the distances 1 / nearness under `radius` squared; 0 where there are none.
float mean_square_within(const Nearness& nearness, float radius);

}  // namespace lucarne::octree
