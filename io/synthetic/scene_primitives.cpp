// Primitive bodies on a floor under the open sky, as in the test scenes of point-based daylight (Harada
// 2014).
#include <cmath>
#include <vector>

#include "io/synthetic/scenes.h"

namespace lucarne::io {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr int kSegments = 96;

void ball(PatchBuilder& builder, Finish finish, const dvec3& foot, double radius) {
    constexpr int kRings = kSegments / 2;
    std::vector<dvec2> profile;
    for (int ring = 0; ring <= kRings; ++ring) {
        const double angle = M_PI * ring / kRings;
        profile.emplace_back(radius * std::sin(angle), radius * (1 - std::cos(angle)));
    }
    builder.revolve(finish, foot, profile, kSegments);
}

}  // namespace

SceneModel build_primitives() {
    using enum Finish;
    constexpr double kFloor = 6;
    PatchBuilder b;
    b.rectangle(slabs, {-kFloor, -kFloor, 0}, {2 * kFloor, 0, 0}, {0, 2 * kFloor, 0});
    b.box(white, {-2.6, .4, 0}, {-1.2, 1.8, 1.4}, PatchBuilder::kNoBottom);
    b.box(ochre, {.9, -2.2, 0}, {2.5, -1.6, .8}, PatchBuilder::kNoBottom);
    b.box(teal, {-.3, 2.4, 0}, {3.2, 2.8, 2.2}, PatchBuilder::kNoBottom);
    ball(b, red, {.2, .2, 0}, .8);
    ball(b, marble, {-1.4, -1.3, 0}, .5);
    const dvec2 cylinder[] = {{.5, 0}, {.5, 1.8}, {0, 1.8}}, cone[] = {{.7, 0}, {0, 1.6}};
    b.revolve(green, {2.2, .8, 0}, cylinder, kSegments);
    b.revolve(plaster, {-2.6, -1.0, 0}, cone, kSegments);
    return {b.take(),
            {{.3, -4.2, 1.7}, {4.2, .2, 1.7}, {-4.2, .3, 1.7}, {.4, 4.6, 1.9}, {-.9, -.4, 2.4}},
            {-5, -5, 1.2},
            {5, 5, 2.6}};
}

}  // namespace lucarne::io
