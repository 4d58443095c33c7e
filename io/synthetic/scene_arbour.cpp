// The arbour: a bust on a pillar under beams that are overgrown with leaves, outdoors.
#include <cmath>

#include <glm/geometric.hpp>

#include "io/core/random.h"
#include "io/synthetic/scenes.h"

namespace lucarne::io {
namespace {

using glm::dvec2;
using glm::dvec3;
using enum Finish;

constexpr double kHalf = 1.5;  ///< from the middle to the posts
constexpr double kBeams = 2.6;
constexpr int kLeaves = 2200;

/// Adds a leaf that hangs from `stem` and is as thick as 2 mm in its middle. `along` is a unit direction, not
/// vertical.
void leaf(PatchBuilder& b, const dvec3& stem, const dvec3& along, double length) {
    const dvec3 side = glm::normalize(glm::cross(along, dvec3(0, 0, 1)));
    const double half = .3 * length;
    const dvec2 section[] = {{-half, 0}, {0, -.001}, {half, 0}, {0, .001}, {-half, 0}};
    const dvec3 path[] = {stem, stem + along * (.5 * length) + dvec3(0, 0, .06 * length),
                          stem + along * length};
    b.sweep(green, path, side, section);
}

/// Adds leaves about the beams: most lie flat, some hang at the sides.
void add_leaves(PatchBuilder& b) {
    Random random(2026);
    for (int i = 0; i < kLeaves; ++i) {
        const bool hangs = i % 5 == 0;
        const double x = (2 * random.uniform() - 1) * (kHalf + .25),
                     y = (2 * random.uniform() - 1) * (kHalf + .25);
        const double turn = 2 * M_PI * random.uniform(), dip = hangs ? -1.1 : -.35 + .5 * random.uniform();
        const double z = kBeams + .10 + .22 * random.uniform() - (hangs ? .25 : 0);
        const dvec3 along(std::cos(turn) * std::cos(dip), std::sin(turn) * std::cos(dip), std::sin(dip));
        leaf(b, {x, y, z}, along, .10 + .08 * random.uniform());
    }
}

/// Adds head and shoulders: a body of revolution, pressed flat from front to back.
void add_bust(PatchBuilder& b, double foot) {
    const dvec2 profile[] = {{.10, 0},    {.10, .03}, {.07, .06},  {.06, .10},  {.10, .13},
                             {.17, .16},  {.23, .21}, {.25, .27},  {.23, .33},  {.15, .38},
                             {.085, .42}, {.07, .46}, {.07, .50},  {.095, .54}, {.12, .60},
                             {.13, .67},  {.12, .74}, {.085, .79}, {.04, .82},  {0, .825}};
    constexpr int kColumns = 72;
    Grid body;
    body.close_columns = true;
    for (const dvec2& point : profile) {
        // Shoulders are broader than deep; the neck and the head are nearly round.
        const double depth = point.y > .12 && point.y < .42 ? .62 : .95;
        auto& row = body.rows.emplace_back();
        for (int i = 0; i < kColumns; ++i) {
            const double angle = 2 * M_PI * i / kColumns;
            row.emplace_back(point.x * std::cos(angle), depth * point.x * std::sin(angle), foot + point.y);
        }
    }
    b.grid(marble, body);
}

}  // namespace

SceneModel build_arbour() {
    PatchBuilder b;
    const Outline ground[] = {{{-4, -4}, {4, -4}, {4, 4}, {-4, 4}},
                              {{-.3, -.3}, {.3, -.3}, {.3, .3}, {-.3, .3}}};
    b.sheet(slabs, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, ground);
    b.box(ashlar, {-.3, -.3, 0}, {.3, .3, .12}, PatchBuilder::kNoBottom);
    b.box(rubbed_stone, {-.2, -.2, .12}, {.2, .2, .95}, 15);
    b.box(rubbed_stone, {-.26, -.26, .95}, {.26, .26, 1.02});
    add_bust(b, 1.02);
    for (const double x : {-kHalf, kHalf}) {
        for (const double y : {-kHalf, kHalf})
            b.box(wood, {x - .05, y - .05, 0}, {x + .05, y + .05, kBeams}, 15);
        b.box(wood, {x - .05, -kHalf - .3, kBeams}, {x + .05, kHalf + .3, kBeams + .1});
    }
    for (int i = -4; i <= 4; ++i) {
        const double y = i * kHalf / 4;
        b.box(wood, {-kHalf - .3, y - .02, kBeams + .1}, {kHalf + .3, y + .02, kBeams + .16});
    }
    add_leaves(b);
    return {b.take(),
            {{2.6, -1.9, 1.6},
             {-2.4, -2.5, 1.7},
             {-2.7, 2.2, 1.5},
             {2.2, 2.7, 1.6},
             {.9, -1.0, 1.4},
             {-.9, 1.0, 1.5},
             {2.8, -2.8, 4.2},
             {-2.8, 2.8, 4.2}},
            {-3, -3, 1.2},
            {3, 3, 1.9}};
}

}  // namespace lucarne::io
