#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <glm/vec3.hpp>

#include "io/core/error.h"
#include "io/synthetic/scene_geometry.h"

namespace lucarne::io {

/// The true surface of a virtual scene as triangles. Corners are counter-clockwise seen from the air.
struct SurfaceMesh {
    struct Vertex {
        glm::vec3 position, normal;     ///< metres; unit length, towards the air, as SurfaceHit's
        std::array<uint8_t, 3> albedo;  ///< sRGB codes, as the scanner records them
    };
    std::vector<Vertex> vertices;
    std::vector<std::array<uint32_t, 3>> triangles;
};

/// Side of the cells into which surfaces with a pattern are divided by default, metres.
inline constexpr double kMeshStep = .05;

/// Divides surfaces whose albedo varies into cells of at most `step` metres a side; surfaces of one colour
/// stay as they are. The albedo of a vertex is the mean over half a cell around it, so that joints finer than
/// a cell keep their share of the light.
SurfaceMesh surface_mesh(const PatchMesh& patches, double step);

/// Writes a mesh as binary PLY: vertices with x, y, z, nx, ny, nz (float) and red, green, blue (uchar), and
/// triangles.
Result<void> write_surface_mesh(const SurfaceMesh& mesh, const std::filesystem::path& path, bool overwrite);

}  // namespace lucarne::io
