#pragma once

#include <array>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "gi/volume/grid.h"
#include "io/core/error.h"
#include "io/formats/mesh/mesh.h"
#include "io/formats/mesh/surface.h"

namespace lucarne::gi::volume {

/// Voxels along the longest side of a grid about a mesh.
inline constexpr uint32_t kMostMeshVoxels = 1024;

/// A triangle of a mesh in a grid.
struct GridTriangle {
    std::array<glm::dvec3, 3> corners;  ///< in units of voxels, inside the grid
    std::array<glm::vec3, 3> albedo;    ///< of the corners, linear Rec. 709

    /// Returns twice the area in voxel faces, as a vector along the normal of the side from which the corners
    /// turn left.
    glm::dvec3 cross() const;
};

/// Returns the axis along which a triangle with this normal (of any length) projects to the largest area; of
/// equal ones the first.
inline int dominant_axis(const glm::dvec3& normal) {
    const glm::dvec3 n = glm::abs(normal);
    return n.x >= n.y && n.x >= n.z ? 0 : n.y >= n.z ? 1 : 2;
}

/// The triangles of a mesh, and the tightest grid about them.
class MeshTriangles {
 public:
    /// `mesh` must be finished and must outlive this. `longest`: voxels along the longest side of its box, 1
    /// to kMostMeshVoxels. Errors: no triangles; a number of voxels out of range, a box beyond the range of
    /// float.
    static Result<MeshTriangles> create(const io::mesh::Mesh& mesh, double metres_per_unit, uint32_t longest);

    /// The grid's coordinates are relative to origin(), m.
    const Grid& grid() const { return grid_; }
    const glm::dvec3& origin() const { return origin_; }
    size_t count() const { return mesh_->triangles.size(); }
    /// Returns the area of the mesh, m^2.
    double area() const { return mesh_->area() * metres_per_unit_ * metres_per_unit_; }
    GridTriangle operator[](size_t triangle) const;

 private:
    MeshTriangles(const io::mesh::Mesh& mesh, double spacing) : mesh_(&mesh), surface_(mesh, spacing) {}

    const io::mesh::Mesh* mesh_;
    io::mesh::Surface surface_;  ///< samples textures over a voxel
    double metres_per_unit_ = 1, voxels_per_unit_ = 1;
    Grid grid_;
    glm::dvec3 origin_{0.0};
};

}  // namespace lucarne::gi::volume
