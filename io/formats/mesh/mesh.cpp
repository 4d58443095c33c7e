#include "io/formats/mesh/mesh.h"

#include <algorithm>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "io/formats/common/format.h"
#include "io/formats/mesh/triangulate.h"

namespace lucarne::io::mesh {

bool Mesh::colored() const {
    return !colors.empty() || !face_colors.empty() ||
           std::any_of(materials.begin(), materials.end(),
                       [](const Material& m) { return m.color || m.texture != kNone; });
}

void Mesh::add(std::span<const Corner> polygon, uint32_t material, std::optional<Color8> color) {
    if (polygon.size() < 3) {
        ++without_area;
        return;
    }
    std::vector<glm::dvec3> outline;
    std::vector<std::array<uint32_t, 3>> cut;
    for (const Corner& c : polygon) {
        const glm::dvec3& p = outline.emplace_back(positions[c.position]);
        if (usable(p.x) && usable(p.y) && usable(p.z)) continue;
        // Without this position neither the outline nor the inside of the polygon is known.
        not_finite += polygon.size() - 2;
        return;
    }
    fanned += !triangulate(outline, cut);
    // A list that only some triangles need begins with the first of these.
    const auto put = [&](auto& list, bool has, const auto& value, const auto& none) {
        if (list.empty() && !has) return;
        list.resize(triangles.size(), none);
        list.push_back(value);
    };
    const Corners no_corners = {kNone, kNone, kNone};
    for (const auto& [a, b, c] : cut) {
        const std::array corners = {polygon[a], polygon[b], polygon[c]};
        const auto of = [&](uint32_t Corner::*what) {
            return Corners{corners[0].*what, corners[1].*what, corners[2].*what};
        };
        const Corners at = of(&Corner::coordinate), facing = of(&Corner::normal);
        put(coordinate_corners, at != no_corners, at, no_corners);
        put(normal_corners, facing != no_corners, facing, no_corners);
        put(face_colors, color.has_value(), color.value_or(Color8{}), Color8{});
        put(face_materials, material != kNone, material, kNone);
        triangles.push_back(of(&Corner::position));
    }
}

void Mesh::finish() {
    // If no corner has indices, the entries belong to the positions, provided that there is one for each.
    if (normal_corners.empty() && normals.size() != positions.size()) normals.clear();
    if (coordinate_corners.empty() && coordinates.size() != positions.size()) coordinates.clear();
    const auto each_list = [&](const auto& call) {
        for (auto* list : {&coordinate_corners, &normal_corners}) call(*list, Corners{kNone, kNone, kNone});
        call(face_colors, Color8{});
        call(face_materials, kNone);
    };
    each_list([&](auto& list, const auto& none) {
        if (!list.empty()) list.resize(triangles.size(), none);
    });
    low = glm::dvec3(std::numeric_limits<double>::infinity());
    high = -low;
    area_before.assign(1, 0.0);
    area_before.reserve(triangles.size() + 1);
    size_t kept = 0;
    for (size_t i = 0; i < triangles.size(); ++i) {
        const auto [a, b, c] = points(i);
        const double area = glm::length(glm::cross(b - a, c - a)) / 2;
        if (!(area > 0)) {
            ++without_area;
            continue;
        }
        low = glm::min(low, glm::min(a, glm::min(b, c)));
        high = glm::max(high, glm::max(a, glm::max(b, c)));
        area_before.push_back(area_before.back() + area);
        triangles[kept] = triangles[i];
        each_list([&](auto& list, const auto&) {
            if (!list.empty()) list[kept] = list[i];
        });
        ++kept;
    }
    triangles.resize(kept);
    each_list([&](auto& list, const auto&) { list.resize(std::min(list.size(), kept)); });
    if (kept == 0) low = high = glm::dvec3(0.0);
}

}  // namespace lucarne::io::mesh
