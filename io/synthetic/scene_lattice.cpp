// The lattice: a sealed room of 6 x 4 x 3 m with thin screens, and a wall at 45 degrees that shuts off a
// corner. Methods that divide space into upright cells mix the two sides of such things.
#include <cmath>
#include <utility>

#include "io/synthetic/scenes.h"

namespace lucarne::io {
namespace {

using glm::dvec2;
using glm::dvec3;
using enum Finish;

constexpr double kBoxX = 6, kBoxY = 4, kBoxZ = 3;

/// Adds the wall at 45 degrees from (6 - side, 0) to (6, side), 2 cm thick. It reaches a little into the
/// walls, floor and ceiling, so that no ray passes along its edges.
void add_diagonal(PatchBuilder& b, double side) {
    constexpr double kInto = .005;
    const double back = side - .02 * M_SQRT2;
    const dvec3 up(0, 0, kBoxZ + 2 * kInto);
    const double front_step = side + 2 * kInto, back_step = back + 2 * kInto;
    b.rectangle(white, {kBoxX + kInto, side + kInto, -kInto}, {-front_step, -front_step, 0}, up);
    b.rectangle(teal, {kBoxX - back - kInto, -kInto, -kInto}, {back_step, back_step, 0}, up);
}

/// Adds a board of 1.5 cm with square holes, 12 cm wide and 20 cm apart.
void add_pierced_board(PatchBuilder& b) {
    constexpr double kThick = .015, kWide = 2.4, kTall = 2.0, kPitch = .2, kHole = .12;
    const Plane front{{1.9, 3.0, .3}, {1, 0, 0}, {0, 0, 1}};  // air at lower y
    const Plane rear{{1.9, 3.0 + kThick, .3}, {-1, 0, 0}, {0, 0, 1}};
    const auto square = [](double u, double v, double width, double height) {
        return Outline{{u, v}, {u + width, v}, {u + width, v + height}, {u, v + height}};
    };
    std::vector<Outline> outlines = {square(0, 0, kWide, kTall)};
    for (int row = 0; row < 10; ++row)
        for (int column = 0; column < 12; ++column) {
            outlines.push_back(square(kPitch * column + (kPitch - kHole) / 2,
                                      kPitch * row + (kPitch - kHole) / 2, kHole, kHole));
            b.extrude(white, front, outlines.back(), kThick, PatchBuilder::Air::inside);
        }
    b.extrude(white, front, outlines.front(), kThick, PatchBuilder::Air::outside);
    b.sheet(white, front, outlines);
    for (Outline& outline : outlines) outline = mirrored(std::move(outline));
    b.sheet(red, rear, outlines);
}

}  // namespace

SceneModel build_lattice() {
    constexpr unsigned kSides = 15, kFloor = 16, kCeiling = 32;
    PatchBuilder b;
    const dvec3 size(kBoxX, kBoxY, kBoxZ);
    b.box(ochre, dvec3(0), size, kSides, PatchBuilder::Air::inside);
    b.box(boards, dvec3(0), size, kFloor, PatchBuilder::Air::inside);
    b.box(white, dvec3(0), size, kCeiling, PatchBuilder::Air::inside);
    add_diagonal(b, 2.2);
    add_pierced_board(b);
    // A screen of upright slats, 1 x 5 cm, from wall to wall and from floor to ceiling.
    for (int i = 0; i < 40; ++i) b.box(wood, {1.2, .025 + .1 * i, 0}, {1.21, .075 + .1 * i, kBoxZ}, kSides);
    // A louvre of slats at 45 degrees, 12 cm wide and 8 mm thick, which overlap seen from the side.
    const double across = .12 * M_SQRT1_2, thick = .008 * M_SQRT1_2;
    for (int i = 0; i < 22; ++i) {
        const double z = .3 + .08 * i;
        const dvec2 low(2.4, z);
        b.prism(white, {{0, .5, 0}, {1, 0, 0}, {0, 0, 1}},
                {low, low + dvec2(thick, -thick), low + dvec2(across + thick, across - thick),
                 low + dvec2(across, across)},
                1.4);
    }
    return {b.take(),
            {{.6, 1.0, 1.5},
             {.6, 3.2, 1.6},
             {1.9, 2.4, 1.4},
             {3.4, 2.4, 1.6},
             {3.2, 1.0, 1.5},
             {5.2, 3.3, 1.6},
             {2.6, 3.5, 1.4},
             {5.3, .8, 1.5}},
            {2.9, 1.9, 1.2},
            {5.5, 2.8, 1.9}};
}

}  // namespace lucarne::io
