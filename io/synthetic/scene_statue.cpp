// The statue: a trefoil knot of swelling marble limbs on a plinth, outdoors.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "io/synthetic/scenes.h"

namespace lucarne::io {
namespace {

using glm::dvec3;

/// Adds a tube around the curve that winds twice about a torus and three times through it. The torus stands
/// upright, its axis along y through the origin. The tube's lowest points are at height `foot`.
void trefoil(PatchBuilder& builder, double foot) {
    constexpr double kRing = .52, kWinding = .24;  // radii of the torus, metres
    constexpr int kSteps = 720, kSides = 56;
    const auto on_torus = [&](double a, double radius) {
        const double around = 2 * a, through = 3 * a, out = kRing + radius * std::cos(through);
        return dvec3(out * std::sin(around), radius * std::sin(through), out * std::cos(around));
    };
    Grid tube;
    tube.close_rows = tube.close_columns = true;
    for (int i = 0; i < kSteps; ++i) {
        const double a = 2 * M_PI * i / kSteps, radius = .125 + .03 * std::cos(3 * a + .6);
        const dvec3 at = on_torus(a, kWinding);
        const dvec3 tangent = glm::normalize(on_torus(a + 1e-4, kWinding) - on_torus(a - 1e-4, kWinding));
        const dvec3 side = glm::normalize(at - on_torus(a, 0)),
                    up = cross(tangent, side);  // the torus' normal first
        auto& row = tube.rows.emplace_back();
        for (int k = 0; k < kSides; ++k) {
            const double angle = 2 * M_PI * k / kSides;
            row.push_back(at + (side * std::cos(angle) + up * std::sin(angle)) * radius);
        }
    }
    double lowest = 0;
    for (const auto& row : tube.rows)
        for (const dvec3& point : row) lowest = std::min(lowest, point.z);
    for (auto& row : tube.rows)
        for (dvec3& point : row) point.z += foot - lowest;
    builder.grid(Finish::marble, tube);
}

}  // namespace

SceneModel build_statue() {
    using enum Finish;
    PatchBuilder b;
    // The ground around the plinth.
    const Outline ground[] = {{{-5, -5}, {5, -5}, {5, 5}, {-5, 5}},
                              {{-.7, -.7}, {.7, -.7}, {.7, .7}, {-.7, .7}}};
    b.sheet(slabs, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, ground);
    b.box(ashlar, {-.7, -.7, 0}, {.7, .7, .2}, PatchBuilder::kNoBottom);
    b.box(ashlar, {-.55, -.55, .2}, {.55, .55, .95}, 15);
    b.box(rubbed_stone, {-.65, -.65, .95}, {.65, .65, 1.1});
    trefoil(b, 1.08);  // its lower limbs sink 2 cm into the plinth
    return {b.take(),
            {{3.2, -2.4, 1.7}, {-2.6, -3.2, 1.5}, {-3.0, 2.6, 1.8}, {2.6, 3.0, 1.4}},
            {-4.5, -4.5, 1.3},
            {4.5, 4.5, 2.2}};
}

}  // namespace lucarne::io
