// A house of two rooms: daylight through one window, and a room that gets all its light from the other one.
#include "io/synthetic/scenes.h"

namespace lucarne::io {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double kSide = 4, kHeight = 2.6;                               // of each room
constexpr double kWall = .2;                                             // thickness of walls and roof
constexpr double kSecond = kSide + kWall;                                // where the second room begins
constexpr double kEnd = kSecond + kSide;                                 // where it ends
const Outline kWindow{{1.2, .9}, {2.8, .9}, {2.8, 2.2}, {1.2, 2.2}};     // x, z
const Outline kDoorway{{2.4, 0}, {3.3, 0}, {3.3, 2.0}, {2.4, 2.0}};      // y, z
const Outline kTransom{{2.4, 2.1}, {3.3, 2.1}, {3.3, 2.4}, {2.4, 2.4}};  // y, z: an opening over the door

/// Adds floors, ceilings and the three walls of each room that are not the wall between them.
void add_rooms(PatchBuilder& b) {
    constexpr unsigned kX0 = 1, kX1 = 2, kSouth = 4, kNorth = 8, kFloor = 16, kCeiling = 32;
    constexpr auto kInside = PatchBuilder::Air::inside;
    const double middle = kSide + kWall / 2;
    for (const bool second : {false, true}) {
        const dvec3 min(second ? middle : 0, 0, 0), max(second ? kEnd : middle, kSide, kHeight);
        b.box(second ? Finish::teal : Finish::ochre, min, max, kNorth | (second ? kX1 | kSouth : kX0),
              kInside);
        b.box(Finish::boards, min, max, kFloor, kInside);
        b.box(Finish::white, min, max, kCeiling, kInside);
    }
    const Outline south[] = {{{0, 0}, {middle, 0}, {middle, kHeight}, {0, kHeight}}, kWindow};
    const Outline inner[] = {mirrored(south[0]), mirrored(south[1])};
    b.sheet(Finish::ochre, {{0, 0, 0}, {-1, 0, 0}, {0, 0, 1}}, inner);
}

/// Adds the wall between the rooms, with a shut door and an opening over it.
void add_middle_wall(PatchBuilder& b) {
    const Outline wall{{0, 0}, {kSide, 0}, {kSide, kHeight}, {0, kHeight}};
    const Outline outlines[] = {wall, kDoorway, kTransom};
    const Outline from_first[] = {mirrored(wall), mirrored(kDoorway), mirrored(kTransom)};
    const Plane second_face{{kSecond, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    b.sheet(Finish::ochre, {{kSide, 0, 0}, {0, -1, 0}, {0, 0, 1}}, from_first);
    b.sheet(Finish::teal, second_face, outlines);
    const Outline jambs{kDoorway[1], kDoorway[2], kDoorway[3],
                        kDoorway[0]};  // no sill: the floor runs through
    b.extrude(Finish::white, second_face, jambs, kWall, PatchBuilder::Air::inside, false);
    b.extrude(Finish::white, second_face, kTransom, kWall, PatchBuilder::Air::inside);
    b.box(Finish::wood, {kSide + .08, 2.39, 0}, {kSide + .12, 3.31, 2.01}, PatchBuilder::kNoBottom);
}

/// Adds the outer walls, the roof and a terrace before the window.
void add_outside(PatchBuilder& b) {
    constexpr unsigned kSouth = 4, kFloor = 16;
    const dvec3 min(-kWall, -kWall, -kWall), max(kEnd + kWall, kSide + kWall, kHeight + kWall);
    b.box(Finish::plaster, min, max, PatchBuilder::kAllFaces & ~(kSouth | kFloor));
    const Outline south[] = {{{min.x, min.z}, {max.x, min.z}, {max.x, max.z}, {min.x, max.z}}, kWindow};
    const Plane facade{{0, -kWall, 0}, {1, 0, 0}, {0, 0, 1}};
    b.sheet(Finish::plaster, facade, south);
    b.extrude(Finish::white, facade, kWindow, kWall, PatchBuilder::Air::inside);
    b.rectangle(Finish::slabs, {min.x, -3, min.z}, {max.x - min.x, 0, 0}, {0, 3 - kWall, 0});
}

void add_furniture(PatchBuilder& b) {
    b.box(Finish::wood, {.8, 2.6, .72}, {2.2, 3.4, .76});
    for (const double x : {.84, 2.1})
        for (const double y : {2.64, 3.3}) b.box(Finish::wood, {x, y, 0}, {x + .06, y + .06, .72}, 15);
    b.box(Finish::red_cloth, {6.6, .6, 0}, {7.6, 1.3, .6}, PatchBuilder::kNoBottom);
}

}  // namespace

SceneModel build_house() {
    PatchBuilder b;
    add_rooms(b);
    add_middle_wall(b);
    add_outside(b);
    add_furniture(b);
    // Four stations inside and five around the house, high enough to see the roof.
    return {b.take(),
            {{.8, .7, 1.6},
             {3.3, 2.2, 1.5},
             {5.0, .8, 1.6},
             {7.4, 3.2, 1.5},
             {2.0, -2.4, 1.5},
             {4.1, -4, 5},
             {4.1, 8, 5},
             {-4, 2, 5},
             {12.2, 2, 5}},
            {.5, .5, 1.2},
            {7.7, 3.5, 1.9}};
}

}  // namespace lucarne::io
