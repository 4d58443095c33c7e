#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "io/image/image.h"

// A triangle mesh in memory: the content of an OBJ or PLY file before it is sampled.
namespace lucarne::io::mesh {

inline constexpr uint32_t kNone = 0xffffffff;
using Corners = std::array<uint32_t, 3>;
using Color8 = std::array<uint8_t, 3>;  ///< sRGB

/// The sRGB grey of an albedo of .5, for parts without a colour in a mesh with colours.
inline constexpr Color8 kNoColor = {188, 188, 188};

struct Material {
    std::optional<Color8> color;
    uint32_t texture = kNone;
    glm::dvec2 scale{1.0}, offset{0.0};  ///< applied to texture coordinates
    bool clamp = false;                  ///< beyond its edges the texture is clamped, not repeated
};

/// A corner of a polygon: the index of a position, and the indices of texture coordinates and a normal or
/// kNone.
struct Corner {
    uint32_t position = 0, coordinate = kNone, normal = kNone;
};

struct Mesh {
    std::vector<glm::dvec3> positions;
    std::vector<Color8> colors;          ///< one per position, or none at all
    std::vector<glm::vec3> normals;      ///< any length; zero or non-finite means none
    std::vector<glm::vec2> coordinates;  ///< u points right, v points up

    std::vector<Corners> triangles;  ///< indices of positions
    /// Each list has one entry per triangle or is empty. If these two are empty, normals and coordinates
    /// belong to the positions.
    std::vector<Corners> coordinate_corners, normal_corners;
    std::vector<Color8> face_colors;
    std::vector<uint32_t> face_materials;

    std::vector<Material> materials;
    std::vector<Image8> textures;

    uint64_t without_area = 0, not_finite = 0;  ///< triangles that are left out
    uint64_t fanned = 0;                        ///< polygons with too many corners for ear clipping
    /// The area of all triangles before each triangle, and at the end of all triangles. Set by finish().
    std::vector<double> area_before;
    glm::dvec3 low{0.0}, high{0.0};  ///< bounding box of the triangles

    double area() const { return area_before.empty() ? 0.0 : area_before.back(); }
    bool colored() const;
    std::array<glm::dvec3, 3> points(size_t triangle) const {
        const Corners& c = triangles[triangle];
        return {positions[c[0]], positions[c[1]], positions[c[2]]};
    }

    /// Cuts a polygon into triangles and adds them. The indices must be valid; corners may lack a normal or
    /// coordinates. Leaves out a polygon with an unusable position.
    void add(std::span<const Corner> polygon, uint32_t material, std::optional<Color8> color);
    /// Removes triangles without area and sums up the areas.
    void finish();
};

}  // namespace lucarne::io::mesh
