// Points of simple sites, and where a camera shows a point.
#pragma once

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "gi/scene/scene.h"
#include "viewer/opening/site.h"

namespace lucarne::viewer::sites {

using glm::dvec3;
using Box = std::array<dvec3, 2>;

/// Points on the faces of a box, evenly by area.
inline void add_faces(std::vector<dvec3>& points, const Box& box, size_t count, bool with_roof,
                      uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit;
    const dvec3 side = box[1] - box[0];
    const double area[3] = {side.y * side.z, side.x * side.z, side.x * side.y};
    while (count > 0) {
        const double pick = unit(random) * (area[0] + area[1] + area[2]);
        const int axis = pick < area[0] ? 0 : pick < area[0] + area[1] ? 1 : 2;
        const bool far = unit(random) < .5;
        if (axis == 2 && far && !with_roof) continue;
        dvec3 p = box[0] + side * dvec3(unit(random), unit(random), unit(random));
        p[axis] = box[far][axis];
        points.push_back(p);
        --count;
    }
}

inline std::vector<dvec3> terrain(size_t count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit;
    std::vector<dvec3> points;
    for (size_t i = 0; i < count; ++i) {
        const double x = 400 * unit(random), y = 400 * unit(random);
        points.emplace_back(x, y, 20 * std::sin(x / 60) * std::cos(y / 80));
    }
    return points;
}

inline const Box kRoom = {dvec3(100, 200, 10), dvec3(105, 212, 13)};

inline Site room(double metres_per_unit = 1) {
    std::vector<dvec3> points;
    const Box box = {kRoom[0] / metres_per_unit, kRoom[1] / metres_per_unit};
    add_faces(points, box, 60000, true, 1);
    return survey_site(points, box, metres_per_unit);
}

/// Where a point appears: -1 to 1 to the right and up.
inline glm::dvec2 place(const gi::SceneCamera& camera, const dvec3& point, double aspect) {
    const dvec3 forward = normalize(camera.target - camera.position);
    const dvec3 right = normalize(cross(forward, camera.up)), up = cross(right, forward);
    const dvec3 to = point - camera.position;
    const double half = dot(to, forward) * std::tan(camera.vertical_fov / 2);
    EXPECT_GT(half, 0);
    return {dot(to, right) / (half * aspect), dot(to, up) / half};
}

}  // namespace lucarne::viewer::sites
