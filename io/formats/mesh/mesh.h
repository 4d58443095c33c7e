#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "io/image/image.h"

// A triangle mesh in memory: what OBJ and PLY files hold, before it is sampled.
namespace lucarne::io::mesh {

inline constexpr uint32_t kNone = 0xffffffff;
using Corners = std::array<uint32_t, 3>;
using Color8 = std::array<uint8_t, 3>;  ///< sRGB

/// The sRGB grey of an albedo of .5: where a mesh with colours has none.
inline constexpr Color8 kNoColor = {188, 188, 188};

struct Material {
    std::optional<Color8> color;
    uint32_t texture = kNone;
    glm::dvec2 scale{1.0}, offset{0.0};  ///< of texture coordinates
    bool clamp = false;                  ///< beyond its edges, instead of repeating it
};

/// A corner of a polygon: indices of a position, and of texture coordinates and a normal or kNone.
struct Corner {
    uint32_t position = 0, coordinate = kNone, normal = kNone;
};

struct Mesh {
    std::vector<glm::dvec3> positions;
    std::vector<Color8> colors;          ///< one a position, or none at all
    std::vector<glm::vec3> normals;      ///< any length; 0 and what is not finite: none
    std::vector<glm::vec2> coordinates;  ///< u to the right, v upwards

    std::vector<Corners> triangles;  ///< of positions
    /// One a triangle or none at all. Without corners of their own, normals and coordinates are those of the
    /// positions.
    std::vector<Corners> coordinate_corners, normal_corners;
    std::vector<Color8> face_colors;
    std::vector<uint32_t> face_materials;

    std::vector<Material> materials;
    std::vector<Image8> textures;

    uint64_t without_area = 0, not_finite = 0;  ///< triangles that are left out
    uint64_t fanned = 0;                        ///< polygons too large to be cut by their ears
    /// The area of the triangles before each, and of all at the end; set by finish().
    std::vector<double> area_before;
    glm::dvec3 low{0.0}, high{0.0};  ///< the box of the triangles

    double area() const { return area_before.empty() ? 0.0 : area_before.back(); }
    bool colored() const;
    std::array<glm::dvec3, 3> points(size_t triangle) const {
        const Corners& c = triangles[triangle];
        return {positions[c[0]], positions[c[1]], positions[c[2]]};
    }

    /// Cuts a polygon whose indices are right into triangles, unless one of its positions is not usable.
    /// Corners that lack a normal or coordinates are fine.
    void add(std::span<const Corner> polygon, uint32_t material, std::optional<Color8> color);
    /// Leaves out triangles without area; sums up areas.
    void finish();
};

}  // namespace lucarne::io::mesh
