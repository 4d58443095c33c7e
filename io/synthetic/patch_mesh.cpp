#include "io/synthetic/patch_mesh.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace lucarne::io {
namespace {

constexpr double kTinyArea = 1e-10;      ///< m^2; smaller quads are left out
constexpr double kFlat = 1e-5;           ///< m; a quad with less twist counts as flat
constexpr double kSmoothCosine = 0.766;  ///< cos 40 degrees

double triangle_area(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return glm::length(glm::cross(b - a, c - a)) / 2;
}

/// Returns the distance between the diagonals of a quad: 0 for a flat one.
double twist(const PatchQuad& q) {
    const glm::dvec3 normal = glm::cross(q[2] - q[0], q[3] - q[1]);
    const double length = glm::length(normal);
    return length > 0 ? std::abs(dot(q[1] - q[0], normal)) / length : 0;
}

/// Returns the direction of a quad's air, not normalised. The cross product of the diagonals also works for
/// triangles.
glm::dvec3 face_direction(const PatchQuad& q) {
    return glm::cross(q[2] - q[0], q[3] - q[1]);
}

glm::dvec3 unit_or_up(const glm::dvec3& direction) {
    const double length = glm::length(direction);
    return length > 0 ? direction / length : glm::dvec3(0, 0, 1);
}

template <class Value>
glm::dvec3 bilinear(const Value& at, size_t quad, double t, double s) {
    const glm::dvec3 a(at[4 * quad]), b(at[4 * quad + 1]), c(at[4 * quad + 2]), d(at[4 * quad + 3]);
    return (a * (1 - t) + b * t) * (1 - s) + (d * (1 - t) + c * t) * s;
}

}  // namespace

glm::dvec3 PatchMesh::position(size_t quad, double t, double s) const {
    return bilinear(corners, quad, t, s);
}

glm::dvec3 PatchMesh::normal(size_t quad, double t, double s) const {
    return unit_or_up(bilinear(normals, quad, t, s));
}

Outline mirrored(Outline outline) {
    for (glm::dvec2& corner : outline) corner.x = -corner.x;
    return outline;
}

void PatchBuilder::add_quad(const ShadedQuad& quad, PatchBand& band) {
    const auto& c = quad.corners;
    const double area = triangle_area(c[0], c[1], c[3]) + triangle_area(c[2], c[3], c[1]);
    if (area < kTinyArea) return;
    const double low = glm::length(c[1] - c[0]), high = glm::length(c[2] - c[3]);
    const double height = 2 * area / (low + high);
    mesh_.low_before.push_back(band.low);
    mesh_.high_before.push_back(band.high);
    band.low += height * low;
    band.high += height * high;
    ++band.quads;
    for (int i = 0; i < 4; ++i) {
        mesh_.corners.emplace_back(c[i]);
        mesh_.normals.emplace_back(quad.normals[i]);
    }
}

void PatchBuilder::add(Finish finish, std::span<const std::vector<ShadedQuad>> bands) {
    Patch patch;
    patch.first_band = static_cast<uint32_t>(mesh_.bands.size());
    patch.area_before = mesh_.area();
    patch.finish = finish;
    for (const auto& quads : bands) {
        PatchBand band;
        band.first_quad = static_cast<uint32_t>(mesh_.quads());
        double width = 0;
        for (const ShadedQuad& quad : quads) {
            const auto& [c, n] = quad;
            width += (glm::length(c[1] - c[0]) + glm::length(c[2] - c[3])) / 2;
            if (twist(c) < kFlat) {
                add_quad(quad, band);
            } else {  // two triangles, so that every point between the corners lies on the surface
                add_quad({{c[0], c[1], c[3], c[3]}, {n[0], n[1], n[3], n[3]}}, band);
                add_quad({{c[1], c[1], c[2], c[3]}, {n[1], n[1], n[2], n[3]}}, band);
            }
        }
        if (band.quads == 0) continue;
        mesh_.finishes.resize(mesh_.corners.size() / 4, finish);
        band.height_before = patch.height;
        band.height = band.area() / width;
        band.area_before = patch.area;
        patch.height += band.height;
        patch.area += band.area();
        ++patch.bands;
        mesh_.bands.push_back(band);
    }
    if (patch.bands > 0) mesh_.patches.push_back(patch);
}

void PatchBuilder::grid(Finish finish, const Grid& grid) {
    const size_t row_points = grid.rows.size(), column_points = grid.rows.front().size();
    const size_t bands = grid.close_rows ? row_points : row_points - 1;
    const size_t columns = grid.close_columns ? column_points : column_points - 1;
    const auto quad_at = [&](size_t row, size_t column) {
        const size_t next_row = (row + 1) % row_points, next_column = (column + 1) % column_points;
        return PatchQuad{grid.rows[row][column], grid.rows[row][next_column],
                         grid.rows[next_row][next_column], grid.rows[next_row][column]};
    };
    std::vector<glm::dvec3> faces(bands * columns);
    for (size_t row = 0; row < bands; ++row)
        for (size_t column = 0; column < columns; ++column)
            faces[row * columns + column] = face_direction(quad_at(row, column)) * (grid.flip ? -1.0 : 1.0);
    /// Returns the normal at the corner of a face towards (row + up, column + right).
    const auto corner_normal = [&](size_t row, size_t column, bool right, bool up) {
        const glm::dvec3 own = unit_or_up(faces[row * columns + column]);
        glm::dvec3 sum(0);
        for (const int dr : {0, up ? 1 : -1})
            for (const int dc : {0, right ? 1 : -1}) {
                auto r = static_cast<int64_t>(row) + dr, c = static_cast<int64_t>(column) + dc;
                const auto wrap = [](int64_t& value, size_t size, bool closed) {
                    if (closed) value = (value + static_cast<int64_t>(size)) % static_cast<int64_t>(size);
                    return value >= 0 && value < static_cast<int64_t>(size);
                };
                if (!wrap(r, bands, grid.close_rows) || !wrap(c, columns, grid.close_columns)) continue;
                const glm::dvec3& face = faces[static_cast<size_t>(r) * columns + static_cast<size_t>(c)];
                if (glm::dot(face, own) > kSmoothCosine * glm::length(face)) sum += unit_or_up(face);
            }
        return unit_or_up(glm::length(sum) > 0 ? sum : own);
    };
    std::vector<std::vector<ShadedQuad>> out(bands);
    for (size_t row = 0; row < bands; ++row)
        for (size_t column = 0; column < columns; ++column)
            out[row].push_back(
                {quad_at(row, column),
                 {corner_normal(row, column, false, false), corner_normal(row, column, true, false),
                  corner_normal(row, column, true, true), corner_normal(row, column, false, true)}});
    add(finish, out);
}

void PatchBuilder::rectangle(Finish finish, const glm::dvec3& origin, const glm::dvec3& u,
                             const glm::dvec3& v) {
    grid(finish, {{{origin, origin + u}, {origin + v, origin + u + v}}});
}

void PatchBuilder::sheet(Finish finish, const Plane& plane, std::span<const Outline> outlines) {
    struct Edge {
        glm::dvec2 low, high;
        double u(double v) const { return low.x + (high.x - low.x) * (v - low.y) / (high.y - low.y); }
    };
    // Trapezoidal decomposition: between the heights of all corners there are bands, and in each band the
    // edges that cross it form pairs.
    std::vector<Edge> edges;
    std::vector<double> heights;
    for (const Outline& outline : outlines)
        for (size_t i = 0; i < outline.size(); ++i) {
            const glm::dvec2 a = outline[i], b = outline[(i + 1) % outline.size()];
            heights.push_back(a.y);
            if (a.y != b.y) edges.push_back(a.y < b.y ? Edge{a, b} : Edge{b, a});
        }
    std::sort(heights.begin(), heights.end());
    heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
    const glm::dvec3 normal = glm::normalize(glm::cross(plane.u, plane.v));
    std::vector<std::vector<ShadedQuad>> bands;
    for (size_t i = 0; i + 1 < heights.size(); ++i) {
        const double low = heights[i], high = heights[i + 1];
        std::vector<const Edge*> crossing;
        for (const Edge& edge : edges)
            if (edge.low.y <= low && edge.high.y >= high) crossing.push_back(&edge);
        std::sort(crossing.begin(), crossing.end(), [&](const Edge* a, const Edge* b) {
            return a->u((low + high) / 2) < b->u((low + high) / 2);
        });
        auto& band = bands.emplace_back();
        for (size_t k = 0; k + 1 < crossing.size(); k += 2) {
            const Edge &left = *crossing[k], &right = *crossing[k + 1];
            band.push_back({{plane.at({left.u(low), low}), plane.at({right.u(low), low}),
                             plane.at({right.u(high), high}), plane.at({left.u(high), high})},
                            {normal, normal, normal, normal}});
        }
    }
    add(finish, bands);
}

void PatchBuilder::extrude(Finish finish, const Plane& plane, const Outline& outline, double depth, Air air,
                           bool closed) {
    double twice_area = 0;  // its sign tells the direction of the outline
    for (size_t i = 0; i < outline.size(); ++i) {
        const glm::dvec2 a = outline[i], b = outline[(i + 1) % outline.size()];
        twice_area += a.x * b.y - a.y * b.x;
    }
    const glm::dvec3 back = glm::normalize(glm::cross(plane.u, plane.v)) * -depth;
    Grid surface;
    surface.rows.resize(2);
    for (const glm::dvec2& corner : outline) {
        surface.rows[0].push_back(plane.at(corner));
        surface.rows[1].push_back(plane.at(corner) + back);
    }
    surface.close_columns = closed;
    // cross(along the outline, back) points into an outline that goes round counter-clockwise.
    surface.flip = (twice_area > 0) != (air == Air::inside);
    grid(finish, surface);
}

void PatchBuilder::prism(Finish finish, const Plane& plane, const Outline& outline, double depth) {
    sheet(finish, plane, std::span(&outline, 1));
    extrude(finish, plane, outline, depth, Air::outside);
    const Outline back = mirrored(outline);
    const glm::dvec3 behind = glm::normalize(glm::cross(plane.u, plane.v)) * -depth;
    sheet(finish, {plane.origin + behind, -plane.u, plane.v}, std::span(&back, 1));
}

void PatchBuilder::box(Finish finish, const glm::dvec3& min, const glm::dvec3& max, unsigned faces, Air air) {
    const glm::dvec3 size = max - min;
    for (unsigned face = 0; face < 6; ++face) {
        if (!(faces >> face & 1)) continue;
        const auto axis = static_cast<int>(face / 2);
        const bool high = face % 2 == 1;
        glm::dvec3 origin = min, u(0), v(0);
        if (high) origin[axis] = max[axis];
        u[(axis + 1) % 3] = size[(axis + 1) % 3];
        v[(axis + 2) % 3] = size[(axis + 2) % 3];
        // cross(u, v) points along +axis.
        if (high == (air == Air::outside))
            rectangle(finish, origin, u, v);
        else
            rectangle(finish, origin, v, u);
    }
}

void PatchBuilder::revolve(Finish finish, const glm::dvec3& foot, std::span<const glm::dvec2> profile,
                           int segments, double from, double to) {
    Grid surface;
    surface.close_columns = to - from >= 2 * M_PI;
    const int columns = surface.close_columns ? segments : segments + 1;
    for (const glm::dvec2& point : profile) {
        auto& row = surface.rows.emplace_back();
        for (int i = 0; i < columns; ++i) {
            const double angle = from + (to - from) * i / segments;
            row.push_back(foot + glm::dvec3(point.x * std::cos(angle), point.x * std::sin(angle), point.y));
        }
    }
    grid(finish, surface);
}

void PatchBuilder::sweep(Finish finish, std::span<const glm::dvec3> path, const glm::dvec3& side,
                         std::span<const glm::dvec2> section) {
    glm::dvec2 middle(0);
    for (const glm::dvec2& offset : section) middle += offset / static_cast<double>(section.size());
    Grid surface;
    const auto add_row = [&](size_t i,
                             bool cap) {  // a cap closes an end: its corners meet in the middle
        const glm::dvec3 tangent = path[std::min(i + 1, path.size() - 1)] - path[i > 0 ? i - 1 : 0];
        const glm::dvec3 up = glm::normalize(glm::cross(tangent, side));
        auto& row = surface.rows.emplace_back();
        for (const glm::dvec2& offset : section) {
            const glm::dvec2 at = cap ? middle : offset;
            row.push_back(path[i] + side * at.x + up * at.y);
        }
    };
    add_row(0, true);
    for (size_t i = 0; i < path.size(); ++i) add_row(i, false);
    add_row(path.size() - 1, true);
    // side x up = side x (tangent x side) = tangent. So a section that turns left in (side, up) turns left
    // about the tangent, and (along the section) x (along the path) points outwards.
    grid(finish, surface);
}

}  // namespace lucarne::io
