#include "io/formats/mesh/triangulate.h"

#include <cmath>
#include <numeric>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace lucarne::io::mesh {
namespace {

/// Cutting an ear off changes only whether its two neighbours are ears (Eberly 2002, "Triangulation by ear
/// clipping"). This does not hold for polygons that touch or cross themselves. So when no ear is known, all
/// corners are checked again, but at most this often per polygon, so that the cost stays quadratic.
constexpr int kMostLooks = 4;

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Projects the polygon along the axis nearest to its mean normal, so that it turns left.
std::vector<glm::dvec2> flattened(std::span<const glm::dvec3> polygon) {
    glm::dvec3 normal(0.0);
    for (size_t i = 0; i < polygon.size(); ++i)
        normal += glm::cross(polygon[i] - polygon[0], polygon[(i + 1) % polygon.size()] - polygon[0]);
    const glm::dvec3 size = glm::abs(normal);
    std::vector<glm::dvec2> flat;
    for (const glm::dvec3& whole : polygon) {
        const glm::dvec3 p = whole - polygon[0];
        if (size.z >= size.x && size.z >= size.y)
            flat.emplace_back(normal.z < 0 ? -p.x : p.x, p.y);
        else if (size.y >= size.x)
            flat.emplace_back(normal.y < 0 ? -p.z : p.z, p.x);
        else
            flat.emplace_back(normal.x < 0 ? -p.y : p.y, p.z);
    }
    return flat;
}

bool convex(const std::vector<glm::dvec2>& flat) {
    const size_t n = flat.size();
    double around = 0;  // the polygon must turn left everywhere and go round once
    for (size_t i = 0; i < n; ++i) {
        const glm::dvec2 &a = flat[i], &b = flat[(i + 1) % n], &c = flat[(i + 2) % n];
        if (!(turn(a, b, c) >= 0)) return false;
        const glm::dvec2 in = b - a, out = c - b;
        around += std::atan2(in.x * out.y - in.y * out.x, in.x * out.x + in.y * out.y);
    }
    return around < 7;  // 2 pi for one turn, 4 pi for two
}

bool is_ear(const std::vector<glm::dvec2>& flat, const std::vector<uint32_t>& left, size_t at) {
    const size_t n = left.size();
    const uint32_t before = left[(at + n - 1) % n], tip = left[at], after = left[(at + 1) % n];
    const glm::dvec2 &a = flat[before], &b = flat[tip], &c = flat[after];
    if (!(turn(a, b, c) > 0)) return false;
    for (const uint32_t other : left) {
        const glm::dvec2& p = flat[other];
        // A bridge to a hole visits a place twice, so a point that coincides with a corner is not inside.
        if (p == a || p == b || p == c) continue;
        if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return false;
    }
    return true;
}

/// Returns the first ear from `at` on; `at` itself if there is none.
size_t next_ear(const std::vector<bool>& ears, const std::vector<uint32_t>& left, size_t at) {
    for (size_t tried = 0; tried < left.size() && !ears[left[at]]; ++tried) at = (at + 1) % left.size();
    return at;
}

}  // namespace

bool triangulate(std::span<const glm::dvec3> polygon, std::vector<std::array<uint32_t, 3>>& triangles) {
    triangles.clear();
    const auto corners = static_cast<uint32_t>(polygon.size());
    std::vector<glm::dvec2> flat;
    if (corners > 3) flat = flattened(polygon);
    const bool fan = corners <= 3 || convex(flat);
    if (fan || corners > kMostEarCorners) {
        for (uint32_t i = 2; i < corners; ++i) triangles.push_back({0, i - 1, i});
        return fan;
    }
    std::vector<uint32_t> left(corners);
    std::iota(left.begin(), left.end(), 0u);
    std::vector<bool> ears(corners);
    const auto look = [&](size_t at) { ears[left[at]] = is_ear(flat, left, at); };
    for (size_t i = 0; i < left.size(); ++i) look(i);
    int looks = 0;
    size_t at = 0;
    while (left.size() > 3) {
        const size_t n = left.size();
        size_t ear = next_ear(ears, left, at % n);
        if (!ears[left[ear]] && looks++ < kMostLooks) {
            for (size_t i = 0; i < n; ++i) look(i);
            ear = next_ear(ears, left, ear);
        }
        // If nothing is an ear, the polygon crosses itself, and any corner is cut off.
        triangles.push_back({left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
        look((ear + n - 2) % (n - 1));
        look(ear % (n - 1));
        at = ear;
    }
    triangles.push_back({left[0], left[1], left[2]});
    return true;
}

}  // namespace lucarne::io::mesh
