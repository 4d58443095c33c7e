#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "io/synthetic/albedo.h"

namespace lucarne::io {

/// A run of adjacent quads. The row at the fraction s of its height is as wide as the mix of its lower and
/// upper edges, so the area below s is low s + (high - low) s^2 / 2. This is exact for trapezoids with
/// parallel edges.
struct PatchBand {
    uint32_t first_quad = 0, quads = 0;
    double low = 0, high = 0;  ///< sums over the quads of height times width of the lower and upper edge
    double area_before = 0;    ///< area of the earlier bands of this patch
    double height_before = 0, height = 0;
    double area() const { return (low + high) / 2; }
};

/// A piece of surface that parallel rows can cross from its first band to its last.
struct Patch {
    uint32_t first_band = 0, bands = 0;
    double area_before = 0;  ///< area of the earlier patches
    double area = 0, height = 0;
    Finish finish = Finish::white;
};

/// Surfaces as patches of bands of quads. Corner 4q+i of quad q: i = 0, 1 on its lower edge, 2, 3 on its
/// upper edge, in order around the quad. Normals have unit length and point to the air.
struct PatchMesh {
    std::vector<glm::vec3> corners, normals;
    std::vector<Finish> finishes;  ///< one per quad
    /// The sums `low` and `high` of the band over the quads before this one.
    std::vector<double> low_before, high_before;
    std::vector<PatchBand> bands;
    std::vector<Patch> patches;

    size_t quads() const { return finishes.size(); }
    double area() const { return patches.empty() ? 0 : patches.back().area_before + patches.back().area; }
    /// Interpolate bilinearly in t (along the row) and s (across).
    glm::dvec3 position(size_t quad, double t, double s) const;
    glm::dvec3 normal(size_t quad, double t, double s) const;
};

using PatchQuad = std::array<glm::dvec3, 4>;
struct ShadedQuad {
    PatchQuad corners, normals;
};

/// A plane with axes: (u, v) lies at origin + u * u_axis + v * v_axis. Its air is on the side of cross(u, v).
struct Plane {
    glm::dvec3 origin, u, v;
    glm::dvec3 at(const glm::dvec2& p) const { return origin + u * p.x + v * p.y; }
};
using Outline = std::vector<glm::dvec2>;  ///< a closed polygon; the last corner joins the first
/// Returns the same outline for a plane whose u axis runs the other way.
Outline mirrored(Outline outline);

/// Rows of points, all of the same length, that span a surface.
struct Grid {
    std::vector<std::vector<glm::dvec3>> rows;
    bool close_columns = false;  ///< the last column joins the first
    bool close_rows = false;
    bool flip = false;  ///< the air is on the side of cross(along a row, across rows) unless this is set
};

/// Builds scenes from surfaces.
class PatchBuilder {
 public:
    void add(Finish finish, std::span<const std::vector<ShadedQuad>> bands);
    /// Adds a grid. Each corner normal is the mean of the neighbouring faces' within 40 degrees, so a smooth
    /// surface stays smooth.
    void grid(Finish finish, const Grid& grid);
    void rectangle(Finish finish, const glm::dvec3& origin, const glm::dvec3& u, const glm::dvec3& v);
    /// Adds the part of a plane that is inside an odd number of the outlines (which must not cross): a wall
    /// with openings.
    void sheet(Finish finish, const Plane& plane, std::span<const Outline> outlines);
    /// Adds the surface that an outline sweeps when it moves by `depth` away from the plane's air. It is the
    /// reveal of an opening (air inside the outline) or the sides of a prism (air outside).
    enum class Air { inside, outside };
    void extrude(Finish finish, const Plane& plane, const Outline& outline, double depth, Air air,
                 bool closed = true);
    /// Adds a closed prism: the outline in the plane, its sides and the same outline `depth` behind it.
    void prism(Finish finish, const Plane& plane, const Outline& outline, double depth);
    /// Which faces of a box to build: bits of the directions -x, +x, -y, +y, -z, +z.
    static constexpr unsigned kAllFaces = 63, kNoBottom = 63 & ~16u;
    void box(Finish finish, const glm::dvec3& min, const glm::dvec3& max, unsigned faces = kAllFaces,
             Air air = Air::outside);
    /// Rotates a profile of (radius, height) about the vertical through `foot`, all the way or from one
    /// azimuth to another (radians). The air is on the right of the profile's direction: outside for a
    /// profile that goes up.
    void revolve(Finish finish, const glm::dvec3& foot, std::span<const glm::dvec2> profile, int segments,
                 double from = 0, double to = 2 * M_PI);
    /// Moves a section (offsets along `side` and along cross(tangent, side)) along a path. `side` is constant
    /// and roughly horizontal. For a section that turns left around its path the air is outside. Both ends
    /// are closed.
    void sweep(Finish finish, std::span<const glm::dvec3> path, const glm::dvec3& side,
               std::span<const glm::dvec2> section);

    PatchMesh take() { return std::move(mesh_); }

 private:
    void add_quad(const ShadedQuad& quad, PatchBand& band);
    PatchMesh mesh_;
};

}  // namespace lucarne::io
