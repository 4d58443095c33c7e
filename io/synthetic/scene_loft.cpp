// The loft: one room of 8 x 5 x 3 m with three windows, open stairs and a gallery with a railing.
#include "io/synthetic/scenes.h"

namespace lucarne::io {
namespace {

using glm::dvec2;
using glm::dvec3;
using enum Finish;
using Air = PatchBuilder::Air;

constexpr double kRoomX = 8, kRoomY = 5, kRoomZ = 3;
constexpr double kLoftWall = .25;                 ///< thickness of walls and roof
constexpr double kGallery = 1.7;                  ///< height of its floor
constexpr double kGalleryX = 5.6, kGalleryY = 3;  ///< where it begins
constexpr int kRisers = 8;                        ///< of the stairs
constexpr double kTread = .27, kStairY = 4.05;    ///< step along x; the stairs' open side
constexpr unsigned kWest = 1, kEast = 2, kSouth = 4, kNorth = 8, kBelow = 16, kAbove = 32;

Outline upright(double u0, double v0, double u1, double v1) {
    return {{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}};
}

/// Adds both faces of a wall with windows, and the windows' reveals. `outside` and `inside`: planes whose u
/// axes run in opposite directions, so that an outline of one is mirrored in the other.
void wall_with_windows(PatchBuilder& b, const Plane& outside, const Outline& outer, const Plane& inside,
                       const Outline& inner, std::span<const Outline> windows) {
    std::vector<Outline> facade = {outer}, room = {mirrored(inner)};
    for (const Outline& window : windows) {
        facade.push_back(window);
        room.push_back(mirrored(window));
        b.extrude(white, outside, window, kLoftWall, Air::inside);
    }
    b.sheet(plaster, outside, facade);
    b.sheet(plaster, inside, room);
}

/// Adds the room, its outer walls and roof, and the terrace around it.
void add_shell(PatchBuilder& b) {
    const dvec3 size(kRoomX, kRoomY, kRoomZ), out(kLoftWall);
    b.box(plaster, dvec3(0), size, kEast, Air::inside);
    b.box(teal, dvec3(0), size, kNorth, Air::inside);
    b.box(boards, dvec3(0), size, kBelow, Air::inside);
    b.box(white, dvec3(0), size, kAbove, Air::inside);
    b.box(plaster, -out, size + out, kEast | kNorth | kAbove);
    const Outline south[] = {upright(.9, .5, 2.5, 2.4), upright(3.6, .5, 5.2, 2.4)};  // x, z
    wall_with_windows(b, {{0, -kLoftWall, 0}, {1, 0, 0}, {0, 0, 1}},
                      upright(-kLoftWall, -kLoftWall, kRoomX + kLoftWall, kRoomZ + kLoftWall),
                      {{0, 0, 0}, {-1, 0, 0}, {0, 0, 1}}, upright(0, 0, kRoomX, kRoomZ), south);
    const Outline west = upright(-3.2, .9, -1.6, 2.2);  // -y, z
    wall_with_windows(b, {{-kLoftWall, 0, 0}, {0, -1, 0}, {0, 0, 1}},
                      upright(-kRoomY - kLoftWall, -kLoftWall, kLoftWall, kRoomZ + kLoftWall),
                      {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}, upright(-kRoomY, 0, 0, kRoomZ), std::span(&west, 1));
    // Glazing bars: one upright and one across in each window of the south.
    for (const double x : {1.68, 4.38}) {
        b.box(white, {x, -.15, .5}, {x + .04, -.11, 2.4}, kWest | kEast | kSouth | kNorth);
        b.box(white, {x - .78, -.15, 1.7}, {x + .82, -.11, 1.74}, kSouth | kNorth | kBelow | kAbove);
    }
    const Outline terrace[] = {upright(-4, -4, kRoomX + 2, kRoomY + 2),
                               upright(-kLoftWall, -kLoftWall, kRoomX + kLoftWall, kRoomY + kLoftWall)};
    b.sheet(slabs, {{0, 0, -kLoftWall}, {1, 0, 0}, {0, 1, 0}}, terrace);
}

/// Adds the gallery on its post, and the railing: uprights of 2 cm every 12 cm.
void add_gallery(PatchBuilder& b) {
    b.box(wood, {kGalleryX, kGalleryY, kGallery - .15}, {kRoomX, kRoomY, kGallery},
          PatchBuilder::kAllFaces & ~(kEast | kNorth));
    b.box(wood, {kGalleryX + .04, kGalleryY + .04, 0}, {kGalleryX + .16, kGalleryY + .16, kGallery - .15},
          kWest | kEast | kSouth | kNorth);
    constexpr double kRail = kGallery + .9;
    const auto post = [&](double x, double y) {
        b.box(wood, {x - .01, y - .01, kGallery}, {x + .01, y + .01, kRail}, kWest | kEast | kSouth | kNorth);
    };
    for (int i = 0; i < 20; ++i) post(kGalleryX + .04 + .12 * i, kGalleryY + .03);
    for (int i = 1; i < 9; ++i) post(kGalleryX + .03, kGalleryY + .03 + .12 * i);
    b.box(wood, {kGalleryX, kGalleryY, kRail}, {kRoomX, kGalleryY + .06, kRail + .05},
          PatchBuilder::kAllFaces & ~kEast);
    b.box(wood, {kGalleryX, kGalleryY + .06, kRail}, {kGalleryX + .06, kStairY, kRail + .05},
          PatchBuilder::kAllFaces & ~kSouth);
}

/// Adds open stairs along the north wall: treads without risers, and a string at their open side.
void add_stairs(PatchBuilder& b) {
    constexpr double kRise = kGallery / kRisers, kFoot = kGalleryX - kTread * kRisers;
    for (int i = 1; i < kRisers; ++i)
        b.box(boards, {kFoot + kTread * i - .03, kStairY, kRise * i - .04},
              {kFoot + kTread * (i + 1), kRoomY, kRise * i}, PatchBuilder::kAllFaces & ~kNorth);
    const double slope = kRise / kTread, low = kFoot + .26;
    b.prism(wood, {{0, kStairY - .05, 0}, {1, 0, 0}, {0, 0, 1}},
            {{kFoot - .08, 0},
             {low, 0},
             {kGalleryX, slope * (kGalleryX - low)},
             {kGalleryX, kGallery},
             {kGalleryX - .08, kGallery}},
            .05);
}

void furnish_loft(PatchBuilder& b) {
    constexpr unsigned kSides = kWest | kEast | kSouth | kNorth;
    b.box(red_cloth, {1.2, 1.2, 0}, {4.2, 3.4, .01}, PatchBuilder::kNoBottom);  // a rug
    b.box(wood, {1.9, 1.8, .71}, {3.5, 2.7, .75});
    for (const double x : {1.95, 3.39})
        for (const double y : {1.85, 2.59}) b.box(wood, {x, y, .01}, {x + .06, y + .06, .71}, kSides);
    b.box(linen, {2.0, 3.0, .40}, {3.4, 3.35, .45});  // a bench
    for (const double x : {2.05, 3.29}) b.box(wood, {x, 3.03, 0}, {x + .06, 3.32, .40}, kSides);
    const dvec2 vase[] = {{.07, 0},   {.11, .03}, {.15, .10}, {.16, .17},  {.14, .25}, {.09, .32}, {.06, .37},
                          {.06, .40}, {.08, .43}, {.07, .43}, {.05, .395}, {.05, .36}, {0, .30}};
    b.revolve(marble, {2.7, 2.25, .75}, vase, 48);
    b.box(blue_cloth, {6.0, .5, 0}, {7.7, 1.35, .42}, PatchBuilder::kNoBottom);  // a sofa
    b.box(blue_cloth, {6.0, .2, 0}, {7.7, .5, .85}, PatchBuilder::kNoBottom);
    // Shelves against the east wall, under the gallery.
    for (const double z : {.10, .50, .90, 1.30})
        b.box(wood, {7.65, 3.4, z}, {kRoomX, 4.7, z + .03}, PatchBuilder::kAllFaces & ~kEast);
    for (const double y : {3.37, 4.7})
        b.box(wood, {7.65, y, 0}, {kRoomX, y + .03, 1.36}, PatchBuilder::kNoBottom & ~kEast);
    b.box(gold_cloth, {1.4, kRoomY - .03, 1.1}, {2.6, kRoomY, 2.0}, PatchBuilder::kAllFaces & ~kNorth);
}

}  // namespace

SceneModel build_loft() {
    PatchBuilder b;
    add_shell(b);
    add_gallery(b);
    add_stairs(b);
    furnish_loft(b);
    // Five stations in the room, one on the gallery, and six around the house, high enough to see the roof.
    return {b.take(),
            {{1.0, .9, 1.5},
             {4.8, 1.0, 1.6},
             {1.0, 4.2, 1.6},
             {4.9, 3.3, 1.4},
             {7.0, 2.3, 1.7},
             {6.6, 3.9, .9},
             {7.1, 4.1, 2.4},
             {2.0, -3, 1.6},
             {6.0, -3.4, 5},
             {-3, 2.5, 1.6},
             {-3.4, 6, 5},
             {4, 8.5, 5},
             {11.5, 2.5, 5}},
            {.5, .5, 1.2},
            {5.0, 4.5, 1.9}};
}

}  // namespace lucarne::io
