// Scenes that focus light: a ring on a floor, and a paraboloid before a wall (Preiner 2010, fig. 13).
#include <cmath>

#include "io/synthetic/scenes.h"

namespace lucarne::io {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr int kSegments = 192;

}  // namespace

SceneModel build_ring() {
    constexpr double kInner = .35, kOuter = .38, kHeight = .2, kFloor = 1.2;
    PatchBuilder b;
    b.rectangle(Finish::white, {-kFloor, -kFloor, 0}, {2 * kFloor, 0, 0}, {0, 2 * kFloor, 0});
    b.rectangle(Finish::white, {-kFloor, kFloor, 0}, {2 * kFloor, 0, 0}, {0, 0, 1.6});
    const dvec2 profile[] = {{kOuter, 0}, {kOuter, kHeight}, {kInner, kHeight}, {kInner, 0}};
    b.revolve(Finish::gilt, {0, 0, 0}, profile, kSegments);
    return {
        b.take(), {{.9, .2, .9}, {-.8, .7, .9}, {-.1, -.9, .9}, {0, 0, .6}}, {-.9, -.9, .6}, {.9, .9, 1.4}};
}

SceneModel build_paraboloid() {
    // y = kVertex - (x^2 + z^2) / (4 f): the paraboloid opens toward the wall at y = kWall.
    constexpr double kFocal = 1.2, kRim = .6, kVertex = 2, kHeight = 1, kWall = .45;
    constexpr int kRings = 40;
    PatchBuilder b;
    b.rectangle(Finish::white, {-1.5, kWall, 0}, {3, 0, 0}, {0, 2.3, 0});
    b.rectangle(Finish::white, {-1.5, kWall, 0}, {0, 0, .9}, {3, 0, 0});
    Grid dish;
    dish.close_columns = dish.flip = true;
    for (int ring = 0; ring <= kRings; ++ring) {
        const double r = kRim * ring / kRings;
        auto& row = dish.rows.emplace_back();
        for (int i = 0; i < kSegments; ++i) {
            const double angle = 2 * M_PI * i / kSegments;
            row.emplace_back(r * std::cos(angle), kVertex - r * r / (4 * kFocal),
                             kHeight + r * std::sin(angle));
        }
    }
    b.grid(Finish::gilt, dish);
    return {b.take(), {{.9, 1.1, .8}, {-.9, 1.0, 1.2}, {.2, .8, .5}}, {-1, .7, .5}, {1, 1.4, 1.6}};
}

}  // namespace lucarne::io
