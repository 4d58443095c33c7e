#include "gi/volume/triangles/mesh_triangles.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/shared/surfel_code.h"

namespace lucarne::gi::volume {
namespace {

/// A box whose extent is a whole number of voxels up to this has no voxel more for the error of rounding.
constexpr double kRounding = 1e-4;
constexpr double kLargestBox = 1e15, kSmallestBox = 1e-15;  ///< m: areas are floats

}  // namespace

glm::dvec3 GridTriangle::cross() const {
    return glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
}

Result<MeshTriangles> MeshTriangles::create(const io::mesh::Mesh& mesh, double metres_per_unit,
                                            uint32_t longest) {
    if (longest < 1 || longest > kMostMeshVoxels)
        return bad_arguments("grid",
                             fmt::format("{} voxels are not between 1 and {}", longest, kMostMeshVoxels));
    if (mesh.triangles.empty()) return rejected("mesh", "it has no triangles with an area");
    const glm::dvec3 extent = (mesh.high - mesh.low) * metres_per_unit;
    const double most = std::max({extent.x, extent.y, extent.z});
    if (!(most < kLargestBox && most > kSmallestBox))
        return rejected("mesh", fmt::format("its extent of {:.3g} m is beyond what can be computed", most));
    Grid grid;
    grid.voxel = static_cast<float>(most / longest);
    const double voxel = static_cast<double>(grid.voxel);
    for (int axis = 0; axis < 3; ++axis)
        grid.size[axis] = std::clamp(static_cast<int>(std::ceil(extent[axis] / voxel - kRounding)), 1,
                                     static_cast<int>(longest));
    MeshTriangles triangles(mesh, voxel / metres_per_unit);
    triangles.metres_per_unit_ = metres_per_unit;
    triangles.voxels_per_unit_ = metres_per_unit / voxel;
    triangles.grid_ = grid;
    triangles.origin_ = mesh.low * metres_per_unit;
    return triangles;
}

GridTriangle MeshTriangles::operator[](size_t triangle) const {
    GridTriangle result;
    const auto points = mesh_->points(triangle);
    constexpr std::array<glm::vec2, 3> kShares = {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 1)};
    for (size_t i = 0; i < 3; ++i) {
        // What lies in the upper side of the box belongs to the last voxels.
        for (int axis = 0; axis < 3; ++axis)
            result.corners[i][axis] = std::clamp((points[i][axis] - mesh_->low[axis]) * voxels_per_unit_, 0.0,
                                                 std::nextafter(static_cast<double>(grid_.size[axis]), 0.0));
        const io::mesh::Color8 color =
            surface_.color({points[i], kShares[i], static_cast<uint32_t>(triangle)});
        for (int channel = 0; channel < 3; ++channel)
            result.albedo[i][channel] =
                srgb_to_linear(static_cast<float>(color[static_cast<size_t>(channel)]) / 255);
    }
    return result;
}

}  // namespace lucarne::gi::volume
