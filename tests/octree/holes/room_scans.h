// Scans of rooms made of rectangles, for tests of holes.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "io/core/random.h"
#include "octree/holes/holes.h"

namespace lucarne::octree::testing {

/// A rectangle that is seen from the side of `normal`.
struct Wall {
    glm::vec3 corner, u, v;
    glm::vec3 normal() const { return glm::normalize(glm::cross(u, v)); }
    float area() const { return glm::length(glm::cross(u, v)); }

    std::optional<float> hit(const glm::vec3& from, const glm::vec3& to) const {
        const glm::vec3 n = normal();
        const float facing = glm::dot(to, n);
        if (std::abs(facing) < 1e-6f) return std::nullopt;
        const float t = glm::dot(corner - from, n) / facing;
        const glm::vec3 at = from + t * to - corner;
        const float a = glm::dot(at, u) / glm::dot(u, u), b = glm::dot(at, v) / glm::dot(v, v);
        if (!(t > 1e-4f && a >= 0 && a <= 1 && b >= 0 && b <= 1)) return std::nullopt;
        return t;
    }
};

/// Five or six sides of a box; `inward`: a room, else a piece of furniture.
inline void add_box(std::vector<Wall>& walls, const glm::vec3& low, const glm::vec3& high, bool inward) {
    const glm::vec3 d = high - low, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
    const auto add = [&](const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v) {
        walls.push_back(inward ? Wall{corner, u, v} : Wall{corner, v, u});
    };
    if (inward) add(low, x, y);  // furniture stands on the floor
    add(low + z, y, x);
    add(low, y, z);
    add(low + x, z, y);
    add(low, z, x);
    add(low + y, x, z);
}

/// An upright column of so many faces with a flat top.
inline void add_column(std::vector<Wall>& walls, const glm::vec3& foot, float radius, float height,
                       int faces) {
    const float step = 2 * std::numbers::pi_v<float> / static_cast<float>(faces);
    const auto corner = [&](int i) {
        const float at = step * static_cast<float>(i);
        return foot + radius * glm::vec3(std::cos(at), std::sin(at), 0);
    };
    for (int i = 0; i < faces; ++i) walls.push_back({corner(i), corner(i + 1) - corner(i), {0, 0, height}});
    const float half = radius * std::numbers::sqrt2_v<float> / 2;  // a square: the rim of the top stays open
    walls.push_back({foot + glm::vec3(-half, -half, height), {2 * half, 0, 0}, {0, 2 * half, 0}});
}

inline std::optional<std::pair<float, size_t>> nearest_wall(const std::vector<Wall>& walls,
                                                            const glm::vec3& from, const glm::vec3& to) {
    std::optional<std::pair<float, size_t>> nearest;
    for (size_t i = 0; i < walls.size(); ++i)
        if (const auto t = walls[i].hit(from, to); t && (!nearest || *t < nearest->first)) nearest = {*t, i};
    return nearest;
}

inline constexpr float kBlind = -0.85f;  ///< z of the lowest directions that a station sees

/// Scans with `columns` x columns / 2 rays a station and 2 mm of noise. The colours are those of the walls:
/// index / 8 in all channels.
inline HoleSample scan_walls(const std::vector<Wall>& walls, const std::vector<glm::vec3>& stations,
                             int columns = 700) {
    HoleSample sample;
    sample.stations = stations;
    Random random(3);
    const float step = 2 * std::numbers::pi_v<float> / static_cast<float>(columns);
    for (size_t s = 0; s < stations.size(); ++s)
        for (int row = 0; row < columns / 2; ++row)
            for (int column = 0; column < columns; ++column) {
                const float up = step * (static_cast<float>(row) + 0.5f) - std::numbers::pi_v<float> / 2,
                            around = step * static_cast<float>(column);
                const glm::vec3 to(std::cos(up) * std::cos(around), std::cos(up) * std::sin(around),
                                   std::sin(up));
                const auto hit = to.z < kBlind ? std::nullopt : nearest_wall(walls, stations[s], to);
                if (!hit) continue;
                const glm::vec3 n = walls[hit->second].normal();
                const float facing = -glm::dot(to, n);
                if (facing < 0.02f) continue;
                const auto noise = static_cast<float>(0.002 * (2 * random.uniform() - 1));
                sample.points.push_back({.position = stations[s] + hit->first * to + noise * n,
                                         .normal = n,
                                         .colour = glm::vec3(static_cast<float>(hit->second) / 8),
                                         .area = hit->first * hit->first * step * step * std::cos(up) /
                                                 facing / static_cast<float>(stations.size()),
                                         .station = static_cast<int32_t>(s)});
            }
    return sample;
}

/// Whether a station sees a place on a wall.
inline bool is_seen(const std::vector<Wall>& walls, const std::vector<glm::vec3>& stations,
                    const glm::vec3& place, const glm::vec3& normal) {
    for (const glm::vec3& station : stations) {
        const float range = glm::length(place - station);
        const glm::vec3 to = (place - station) / range;
        if (to.z < kBlind || glm::dot(to, normal) > -0.02f) continue;
        const auto hit = nearest_wall(walls, station, to);
        if (hit && hit->first > range - 1e-3f) return true;
    }
    return false;
}

/// The area of a wall that no station sees, m^2.
inline float unseen_area(const std::vector<Wall>& walls, const std::vector<glm::vec3>& stations, size_t wall,
                         int side = 200) {
    const Wall& of = walls[wall];
    int unseen = 0;
    for (int i = 0; i < side * side; ++i) {
        const float a = (static_cast<float>(i % side) + 0.5f) / static_cast<float>(side),
                    b = (static_cast<float>(i / side) + 0.5f) / static_cast<float>(side);
        unseen += !is_seen(walls, stations, of.corner + a * of.u + b * of.v, of.normal());
    }
    return of.area() * static_cast<float>(unseen) / static_cast<float>(side * side);
}

inline std::vector<FillPoint> fill_points(const HoleSample& sample, const HoleLimits& limits = {}) {
    return find_holes(sample, limits).points;
}

inline float filled_area(const std::vector<FillPoint>& points) {
    float area = 0;
    for (const FillPoint& point : points) area += point.area;
    return area;
}

/// The distance of a place from the nearest of the walls, m.
inline float distance_to(const std::vector<Wall>& walls, const glm::vec3& place) {
    float nearest = std::numeric_limits<float>::max();
    for (const Wall& wall : walls) {
        const glm::vec3 at = place - wall.corner;
        const float a = glm::clamp(glm::dot(at, wall.u) / glm::dot(wall.u, wall.u), 0.0f, 1.0f),
                    b = glm::clamp(glm::dot(at, wall.v) / glm::dot(wall.v, wall.v), 0.0f, 1.0f);
        nearest = std::min(nearest, glm::length(at - a * wall.u - b * wall.v));
    }
    return nearest;
}

}  // namespace lucarne::octree::testing
