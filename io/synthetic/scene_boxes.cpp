// The scenes made of boxes: the Cornell box, the furnace, two rooms.
#include <cmath>

#include "io/synthetic/scenes.h"

namespace lucarne::io {
namespace {

using glm::dvec2;
using glm::dvec3;

/// Adds a block on the floor: sides and top.
void block(PatchBuilder& builder, Finish finish, const Outline& footprint, double height) {
    const Plane top{{0, 0, height}, {1, 0, 0}, {0, 1, 0}};
    builder.sheet(finish, top, std::span(&footprint, 1));
    builder.extrude(finish, top, footprint, height, PatchBuilder::Air::outside);
}

}  // namespace

SceneModel build_cornell() {
    // Goral et al. 1984, with the measurements of Cornell's web page in metres. Seen from the front (low y),
    // red is on the left. The original's floor is 5.528 m wide; this one is a cube.
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

SceneModel build_two_rooms() {
    using enum Finish;
    constexpr unsigned kX0 = 1, kX1 = 2, kSides = 4 + 8, kFloor = 16, kCeiling = 32;
    constexpr auto kInside = PatchBuilder::Air::inside;
    constexpr double kDepth = 5, kHeight = 3, kMiddle = 4.1, kEnd = 8.2,
                     kWall = .1;  // kWall is half the wall's thickness
    PatchBuilder b;
    // The shell: two boxes that share the corners of their open sides, so that no ray escapes.
    for (const bool second : {false, true}) {
        const dvec3 min(second ? kMiddle : 0, 0, 0), max(second ? kEnd : kMiddle, kDepth, kHeight);
        b.box(second ? teal : ochre, min, max, kSides | (second ? kX1 : kX0), kInside);
        b.box(boards, min, max, kFloor, kInside);
        b.box(white, min, max, kCeiling, kInside);
    }
    // The wall between them, with two doorways (y, z); the first stands open.
    const Outline doorways[] = {{{.8, 0}, {1.7, 0}, {1.7, 2.1}, {.8, 2.1}},
                                {{3.2, 0}, {4.1, 0}, {4.1, 2.1}, {3.2, 2.1}}};
    const auto wall_face = [&](const Plane& plane, double sign, Finish finish) {
        std::vector<Outline> outlines = {
            {{0, 0}, {kDepth, 0}, {kDepth, kHeight}, {0, kHeight}}, doorways[0], doorways[1]};
        for (Outline& outline : outlines)
            for (dvec2& corner : outline) corner.x *= sign;
        b.sheet(finish, plane, outlines);
    };
    const Plane second_face{{kMiddle + kWall, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    wall_face({{kMiddle - kWall, 0, 0}, {0, -1, 0}, {0, 0, 1}}, -1, ochre);
    wall_face(second_face, 1, teal);
    for (const Outline& doorway : doorways) {
        const Outline jambs = {doorway[1], doorway[2], doorway[3],
                               doorway[0]};  // no sill: the floor runs through
        b.extrude(white, second_face, jambs, 2 * kWall, kInside, false);
    }
    // The closed door reaches a little into the wall. The open one stands at a right angle in the second
    // room.
    b.box(wood, {kMiddle - .02, 3.19, 0}, {kMiddle + .02, 4.11, 2.11}, PatchBuilder::kAllFaces & ~kFloor);
    b.box(wood, {kMiddle + kWall + .02, .75, .01}, {kMiddle + kWall + .92, .79, 2.08});
    // A table, a chest and a ball.
    b.box(wood, {1.2, 2.2, .72}, {2.4, 3.0, .76});
    for (const double x : {1.24, 2.3})
        for (const double y : {2.24, 2.9})
            b.box(wood, {x, y, 0}, {x + .06, y + .06, .72}, kX0 | kX1 | kSides);
    b.box(red_cloth, {6.4, 3.6, 0}, {7.4, 4.3, .6}, PatchBuilder::kNoBottom);
    std::vector<dvec2> ball;
    for (int i = 0; i <= 32; ++i) {
        const double angle = M_PI * i / 32;
        ball.emplace_back(.35 * std::sin(angle), .35 * (1 - std::cos(angle)));
    }
    b.revolve(marble, {6.2, 1.6, 0}, ball, 64);
    return {b.take(),
            {{1.0, 1.2, 1.6}, {3.0, 3.9, 1.5}, {5.4, 1.9, 1.6}, {7.3, 2.6, 1.4}},
            {.5, .5, 1.2},
            {7.7, 4.5, 1.9}};
}

}  // namespace lucarne::io
