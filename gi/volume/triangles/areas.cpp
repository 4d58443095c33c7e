#include "gi/volume/triangles/areas.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <glm/geometric.hpp>

#include "gi/volume/polygon.h"
#include "gi/volume/voxel_sums.h"
#include "io/core/parallel.h"

namespace lucarne::gi::volume {
namespace {

constexpr size_t kTrianglesATask = 256, kTrianglesAtOnce = size_t{1} << 16;
/// Parts that are made, and then added, at once; a single triangle may have more.
constexpr double kPartsAtOnce = 1e6;

/// Returns about how many voxels a triangle meets; large ones meet at most three layers of theirs.
double parts_of(const GridTriangle& triangle) {
    return 4 + 1.5 * glm::length(triangle.cross());
}

/// Adds the parts of a triangle.
void divide(const GridTriangle& triangle, const glm::ivec3& size, std::vector<VoxelPart>& parts) {
    const glm::dvec3 cross = triangle.cross();
    const double length = glm::length(cross);
    if (!(length > 0)) return;
    const glm::vec3 normal(cross / length);
    BasicPolygon<double> whole;
    for (const glm::dvec3& corner : triangle.corners) whole.add(corner);
    const glm::dvec3 &a = triangle.corners[0], &b = triangle.corners[1], &c = triangle.corners[2];
    for_each_voxel_of(size, whole, 0.0, [&](const glm::ivec3& cell, const BasicPolygon<double>& part) {
        // Albedos are linear in the triangle, so that of a part is that of its centre of gravity.
        double area = 0;
        glm::dvec3 centre(0.0);
        for (size_t i = 2; i < part.count; ++i) {
            const glm::dvec3 &p = part.corners[0], &q = part.corners[i - 1], &r = part.corners[i];
            const double own = glm::length(glm::cross(q - p, r - p)) / 2;
            area += own;
            centre += own / 3 * (p + q + r);
        }
        if (!(area > 0)) return;
        centre /= area;
        const double u = glm::dot(glm::cross(centre - a, c - a), cross) / (length * length);
        const double v = glm::dot(glm::cross(b - a, centre - a), cross) / (length * length);
        const glm::vec3 albedo = triangle.albedo[0] +
                                 static_cast<float>(u) * (triangle.albedo[1] - triangle.albedo[0]) +
                                 static_cast<float>(v) * (triangle.albedo[2] - triangle.albedo[0]);
        const auto amount = static_cast<float>(area);
        const auto number = static_cast<uint32_t>((cell.z * size.y + cell.y) * size.x + cell.x);
        parts.push_back({number, amount, amount * normal, amount * albedo});
    });
}

}  // namespace

VoxelSet areas_of_triangles(const MeshTriangles& triangles) {
    VoxelSums sums;
    const glm::ivec3 size = triangles.grid().size;
    std::vector<GridTriangle> some;
    std::vector<VoxelPart> all;
    std::vector<std::vector<VoxelPart>> pieces;
    for (size_t first = 0; first < triangles.count(); first += kTrianglesAtOnce) {
        some.resize(std::min(kTrianglesAtOnce, triangles.count() - first));
        parallel_ranges(some.size(), kTrianglesATask, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) some[i] = triangles[first + i];
        });
        for (size_t begin = 0, end = 0; begin < some.size(); begin = end) {
            for (double expected = 0; end < some.size() && expected < kPartsAtOnce; ++end)
                expected += parts_of(some[end]);
            pieces.assign((end - begin + kTrianglesATask - 1) / kTrianglesATask, {});
            parallel_ranges(end - begin, kTrianglesATask, [&](size_t from, size_t to) {
                for (size_t i = from; i < to; ++i)
                    divide(some[begin + i], size, pieces[from / kTrianglesATask]);
            });
            all.clear();
            for (const auto& piece : pieces) all.insert(all.end(), piece.begin(), piece.end());
            sums.add(all);
        }
    }
    return sums.means(triangles.grid(), triangles.origin());
}

}  // namespace lucarne::gi::volume
