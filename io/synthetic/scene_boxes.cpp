// The scenes made of boxes: the Cornell box, the furnace.
#include "io/synthetic/scenes.h"

namespace lucarne::io {
namespace {

using glm::dvec2;
using glm::dvec3;

/// A block on the floor: sides and top.
void block(PatchBuilder& builder, Finish finish, const Outline& footprint, double height) {
    const Plane top{{0, 0, height}, {1, 0, 0}, {0, 1, 0}};
    builder.sheet(finish, top, std::span(&footprint, 1));
    builder.extrude(finish, top, footprint, height, PatchBuilder::Air::outside);
}

}  // namespace

SceneModel build_cornell() {
    // Goral et al. 1984, with the measurements of Cornell's web page in metres: seen from the front (low y),
    // red is on the left. Their floor is 5.528 m wide, ours is a cube.
    constexpr double kSide = 5.5;
    PatchBuilder b;
    const dvec3 x(kSide, 0, 0), y(0, kSide, 0), z(0, 0, kSide);
    b.rectangle(Finish::white, {0, 0, 0}, x, y);
    b.rectangle(Finish::white, z, y, x);
    b.rectangle(Finish::white, y, x, z);
    b.rectangle(Finish::red, {0, 0, 0}, y, z);
    b.rectangle(Finish::green, x, z, y);
    const auto mirrored = [](std::vector<dvec2> corners) {
        for (dvec2& corner : corners) corner = {kSide - corner.x, corner.y};
        return corners;
    };
    block(b, Finish::white, mirrored({{1.30, .65}, {.82, 2.25}, {2.40, 2.72}, {2.90, 1.14}}), 1.65);
    block(b, Finish::white, mirrored({{4.23, 2.47}, {2.65, 2.96}, {3.14, 4.56}, {4.72, 4.06}}), 3.30);
    return {b.take(), {{2.75, .35, 2.6}, {.6, 3.2, 4.3}, {4.9, 4.4, 3.2}}, {.4, .2, 1.2}, {5.1, 5.1, 4.8}};
}

SceneModel build_furnace() {
    PatchBuilder b;
    b.box(Finish::half, dvec3(-1), dvec3(1), PatchBuilder::kAllFaces, PatchBuilder::Air::inside);
    return {b.take(), {{.1, -.2, .05}, {-.5, .4, -.3}}, dvec3(-.5), dvec3(.5)};
}

}  // namespace lucarne::io
