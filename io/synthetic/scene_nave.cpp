// The nave: six bays, 12 m wide, 30 m long, 15 m high. x goes across, y from the portal to the altar, z up.
//
// The vaults are two pointed barrels that meet at a right angle. At (x, y) from a bay's middle the ceiling is
// the higher of the two, z = springing + rise max(g(|x| / a), g(|y| / b)). So all four sides of a bay are
// pointed arches, and the groins are straight in plan. g is the equilateral arch.
#include <cmath>

#include <glm/geometric.hpp>

#include "io/synthetic/scenes.h"

namespace lucarne::io {
namespace {

using glm::dvec2;
using glm::dvec3;
using enum Finish;
using Air = PatchBuilder::Air;

constexpr double kLength = 30, kBay = 5;
constexpr double kNaveHalf = 2.9;    ///< to the nave side of the arcade walls
constexpr double kArcadeAxis = 3.2;  ///< columns stand under the middle of those walls
constexpr double kAisleInner = 3.5, kAisleOuter = 6, kAisleMiddle = 4.75;
constexpr double kArcadeSpringing = 4.2, kArcadeRise = 2.1, kArcadeHalf = 2;
constexpr double kVaultSpringing = 9, kVaultRise = 5.7, kAisleSpringing = 4.4, kAisleRise = 2.5;
constexpr int kArchSteps = 14;  ///< from springing to apex

/// Returns the equilateral pointed arch from (-half, base) over (0, base + rise) to (half, base).
Outline pointed_arch(double half, double base, double rise) {
    Outline arch;
    for (int i = 0; i <= 2 * kArchSteps; ++i) {
        const int step = i <= kArchSteps ? i : 2 * kArchSteps - i;
        const double angle = M_PI / 3 * step / kArchSteps;  // each half is 60 degrees of a circle of radius 2
        const double x = half * (2 * std::cos(angle) - 1),
                     z = base + rise * 2 * std::sin(angle) / std::sqrt(3.0);
        arch.emplace_back(i < kArchSteps ? -x : i == kArchSteps ? 0 : x, z);
    }
    return arch;
}

Outline moved(Outline outline, double u, double v = 0) {
    for (dvec2& corner : outline) corner += dvec2(u, v);
    return outline;
}

/// Returns a window or door with a pointed head.
Outline lancet(double middle, double half, double sill, double springing, double rise) {
    Outline outline = pointed_arch(half, springing, rise);
    outline.emplace_back(half, sill);
    outline.emplace_back(-half, sill);
    return moved(outline, middle);
}

Outline circle(const dvec2& middle, double radius, int steps) {
    Outline outline;
    for (int i = 0; i < steps; ++i) {
        const double angle = 2 * M_PI * (i + .25) / steps;
        outline.push_back(middle + radius * dvec2(std::cos(angle), std::sin(angle)));
    }
    return outline;
}

/// Adds a wall from the `low` corners along its bottom up to a pointed arch, with openings through its
/// thickness.
void pierced_wall(PatchBuilder& b, Finish finish, const Plane& plane, Outline wall,
                  std::span<const Outline> openings, double thickness) {
    std::vector<Outline> outlines = {std::move(wall)};
    outlines.insert(outlines.end(), openings.begin(), openings.end());
    b.sheet(finish, plane, outlines);
    for (const Outline& opening : openings) b.extrude(rubbed_stone, plane, opening, thickness, Air::inside);
}

/// Adds a rib of this half width and depth along an arch. `across` is horizontal and perpendicular to the
/// arch's plane.
void rib(PatchBuilder& b, std::span<const dvec3> path, const dvec3& across, double half, double depth) {
    const dvec2 section[] = {{-half, .04},         {-half, -.4 * depth}, {-.75 * half, -.6 * depth},
                             {-.4 * half, -depth}, {.4 * half, -depth},  {.75 * half, -.6 * depth},
                             {half, -.4 * depth},  {half, .04}};
    b.sweep(rubbed_stone, path, across, section);
}

/// Returns an arch of the vault in the vertical plane through `middle` along `half_span` (horizontal).
std::vector<dvec3> vault_arch(const dvec3& middle, const dvec3& half_span, double rise) {
    std::vector<dvec3> path;
    for (const dvec2& point : pointed_arch(1, 0, rise))
        path.push_back(middle + half_span * point.x + dvec3(0, 0, point.y));
    return path;
}

/// Adds the four webs of one bay, of half sizes a (along x) and b (along y), and its diagonal ribs.
void vault(PatchBuilder& builder, const dvec3& middle, double a, double b, double rise, double rib_half) {
    for (const bool along_y : {true, false})
        for (const double side : {-1.0, 1.0}) {
            // Rows run straight from the groin to the bay's border, at the height of the barrel.
            Grid web;
            web.flip = !along_y;
            for (const dvec2& point : pointed_arch(1, 0, rise)) {
                const double groin = side * std::abs(point.x);
                const double first = side < 0 ? side : groin, last = side < 0 ? groin : side;
                if (along_y)
                    web.rows.push_back({middle + dvec3(a * point.x, b * first, point.y),
                                        middle + dvec3(a * point.x, b * last, point.y)});
                else
                    web.rows.push_back({middle + dvec3(a * first, b * point.x, point.y),
                                        middle + dvec3(a * last, b * point.x, point.y)});
            }
            builder.grid(plaster, web);
        }
    for (const double sign : {-1.0, 1.0}) {
        const dvec3 half(a, sign * b, 0);
        rib(builder, vault_arch(middle, half, rise), glm::normalize(dvec3(-half.y, half.x, 0)), rib_half,
            2.4 * rib_half);
    }
}

void column(PatchBuilder& b, double x, double y) {
    b.box(rubbed_stone, {x - .55, y - .55, 0}, {x + .55, y + .55, .25}, PatchBuilder::kNoBottom);
    const dvec2 profile[] = {{.52, .25},  {.545, .28}, {.555, .33}, {.545, .38}, {.51, .41},
                             {.46, .43},  {.44, .47},  {.445, .51}, {.475, .53}, {.48, .56},
                             {.47, .59},  {.42, .61},  {.40, .65},  {.39, 2},    {.38, 3.42},
                             {.41, 3.44}, {.42, 3.47}, {.41, 3.50}, {.38, 3.52}, {.385, 3.60},
                             {.40, 3.68}, {.43, 3.76}, {.48, 3.84}, {.55, 3.91}, {.59, 3.95}};
    b.revolve(rubbed_stone, {x, y, 0}, profile, 64);
    b.box(rubbed_stone, {x - .62, y - .62, 3.95}, {x + .62, y + .62, kArcadeSpringing});
}

/// Adds the bundle of half-round shafts that carries the ribs of the nave's vault, on side -1 or 1.
void wall_shafts(PatchBuilder& b, double side, double y) {
    const double middle = side < 0 ? 0 : M_PI;  // towards the nave
    const double x = side * kNaveHalf;
    const auto shaft = [&](double offset, double radius) {
        const dvec2 profile[] = {{radius + .04, kArcadeSpringing},
                                 {radius + .04, kArcadeSpringing + .12},
                                 {radius, kArcadeSpringing + .2},
                                 {radius, 8.4},
                                 {radius + .02, 8.42},
                                 {radius + .02, 8.46},
                                 {radius, 8.48},
                                 {radius + .02, 8.6},
                                 {radius + .06, 8.7},
                                 {radius + .12, 8.78}};
        b.revolve(rubbed_stone, {x, y + offset, 0}, profile, 20, middle - M_PI / 2, middle + M_PI / 2);
    };
    shaft(0, .15);
    shaft(-.23, .10);
    shaft(.23, .10);
    const double inner = x - side * .32;
    b.box(rubbed_stone, {std::min(x, inner), std::max(0.0, y - .45), 8.78},
          {std::max(x, inner), std::min(kLength, y + .45), kVaultSpringing});
}

/// Adds one bay of the arcade wall, the clerestory above it and the outer wall of the aisle.
void bay_walls(PatchBuilder& b, double side, double y) {
    constexpr double kHalf = kBay / 2;
    const Outline arch = pointed_arch(kArcadeHalf, kArcadeSpringing, kArcadeRise);
    const auto above_arch = [&](const Outline& top) {  // counter-clockwise from the lower left
        Outline wall = {{-kHalf, kArcadeSpringing}};
        wall.insert(wall.end(), arch.begin(), arch.end());
        wall.emplace_back(kHalf, kArcadeSpringing);
        wall.insert(wall.end(), top.rbegin(), top.rend());
        return wall;
    };
    const Plane nave{{side * kNaveHalf, y, 0}, {0, -side, 0}, {0, 0, 1}};
    const Outline clerestory[] = {lancet(-.85, .52, 8, 10.6, .9), lancet(.85, .52, 8, 10.6, .9),
                                  circle({0, 12.5}, .55, 32)};
    pierced_wall(b, ashlar, nave, above_arch(pointed_arch(kHalf, kVaultSpringing, kVaultRise)), clerestory,
                 kAisleInner - kNaveHalf);
    b.extrude(rubbed_stone, nave, arch, kAisleInner - kNaveHalf, Air::inside, false);

    const Plane aisle{{side * kAisleInner, y, 0}, {0, side, 0}, {0, 0, 1}};
    const Outline aisle_top = pointed_arch(kHalf, kAisleSpringing, kAisleRise);
    const Outline aisle_wall = above_arch(aisle_top);
    b.sheet(ashlar, aisle, std::span(&aisle_wall, 1));

    const Plane outer{{side * kAisleOuter, y, 0}, {0, -side, 0}, {0, 0, 1}};
    Outline outer_wall = {{-kHalf, 0}, {kHalf, 0}};
    outer_wall.insert(outer_wall.end(), aisle_top.rbegin(), aisle_top.rend());
    const Outline window = lancet(0, .6, 1.9, 3.9, 1);
    pierced_wall(b, ashlar, outer, outer_wall, std::span(&window, 1), .5);

    // Mouldings: an archivolt around the arcade's arch, a string course under the windows.
    std::vector<dvec3> path;
    for (const dvec2& point : pointed_arch(kArcadeHalf + .12, kArcadeSpringing, kArcadeRise + .14))
        path.push_back(nave.at(point));
    const dvec2 roll[] = {{-.06, -.06}, {.05, -.06}, {.09, -.03}, {.09, .03}, {.05, .06}, {-.06, .06}};
    // The roll stands out along the wall's normal. In the plane across the path it must turn left about the
    // path's direction.
    b.sweep(rubbed_stone, path, glm::normalize(cross(nave.u, nave.v)), roll);
    const double inner = side * (kNaveHalf - .12);
    b.box(rubbed_stone, {std::min(inner, nave.origin.x), y - kHalf, 7.2},
          {std::max(inner, nave.origin.x), y + kHalf, 7.38});
}

Outline rose_petal(const dvec2& centre, double direction) {
    // Narrow at the hub, round at the rim: polar coordinates about the rose, angles in degrees.
    Outline petal = {{.80, -6}, {1.60, -9.5}, {1.80, -8.6}, {1.93, -6}, {2.0, 0},
                     {1.93, 6}, {1.80, 8.6},  {1.60, 9.5},  {.80, 6}};
    for (dvec2& corner : petal) {
        const double angle = direction + corner.y * M_PI / 180;
        corner = centre + corner.x * dvec2(std::cos(angle), std::sin(angle));
    }
    return petal;
}

/// Adds the walls at both ends: the rose and three lancets over the altar, the portal and three lancets
/// opposite.
void end_walls(PatchBuilder& b) {
    const auto wall = [](double middle, double half, double floor, double springing, double rise) {
        Outline outline = {{-half, floor}, {half, floor}};
        const Outline top = pointed_arch(half, springing, rise);
        outline.insert(outline.end(), top.rbegin(), top.rend());
        return moved(outline, middle);
    };
    const Plane east{{0, kLength, 0}, {1, 0, 0}, {0, 0, 1}}, west{{0, 0, 0}, {-1, 0, 0}, {0, 0, 1}};
    std::vector<Outline> openings = {circle({0, 10.7}, .55, 24)};
    for (int i = 0; i < 12; ++i) openings.push_back(rose_petal({0, 10.7}, 2 * M_PI * (i + .5) / 12));
    for (const double x : {-1.6, 0.0, 1.6}) openings.push_back(lancet(x, .5, 3.4, 5.9, .9));
    pierced_wall(b, ashlar, east, wall(0, kNaveHalf, .51, kVaultSpringing, kVaultRise), openings, .5);

    const Outline portal = lancet(0, 1.2, 0, 2.4, 1.7);
    openings = {portal};
    for (const double x : {-1.5, 0.0, 1.5}) openings.push_back(lancet(x, .5, 6.4, 9.4, .9));
    pierced_wall(b, ashlar, west, wall(0, kNaveHalf, 0, kVaultSpringing, kVaultRise), openings, .5);
    b.sheet(wood, {{0, -.35, 0}, {-1, 0, 0}, {0, 0, 1}}, std::span(&portal, 1));  // the doors, closed

    for (const double side : {-1.0, 1.0}) {
        const double half = kAisleMiddle - kAisleInner;
        const Outline window = lancet(side * kAisleMiddle, .45, 1.9, 3.9, .8);
        pierced_wall(b, ashlar, east, wall(side * kAisleMiddle, half, 0, kAisleSpringing, kAisleRise),
                     std::span(&window, 1), .5);
        const Outline blind = wall(side * kAisleMiddle, half, 0, kAisleSpringing, kAisleRise);
        b.sheet(ashlar, west, std::span(&blind, 1));
        for (const double y : {0.0, kLength - .5}) {  // half piers carry the ends of the arcades
            const double x = side * kArcadeAxis;
            b.box(ashlar, {x - .3, y, 0}, {x + .3, y + .5, 3.95}, 15);
            b.box(rubbed_stone, {x - .45, std::max(0.0, y - .12), 3.95},
                  {x + .45, std::min(kLength, y + .62), kArcadeSpringing});
        }
    }
}

void sanctuary(PatchBuilder& b) {
    // Three steps across the nave, the runner lying on them, and the platform.
    for (int step = 0; step < 3; ++step) {
        const double y = 25.5 + .4 * step, z = .17 * step, back = step < 2 ? y + .4 : kLength;
        const std::array<double, 4> cuts = {-kNaveHalf, -.9, .9, kNaveHalf};
        for (size_t i = 0; i < 3; ++i) {
            const Finish finish = i == 1 ? carpet : rubbed_stone;
            const double end = i == 1 && step == 2 ? 27.4 : back;  // the runner ends before the altar
            const double width = cuts[i + 1] - cuts[i];
            b.rectangle(finish, {cuts[i], y, z}, {width, 0, 0}, {0, 0, .17});
            b.rectangle(finish, {cuts[i], y, z + .17}, {width, 0, 0}, {0, end - y, 0});
            if (end < back)
                b.rectangle(rubbed_stone, {cuts[i], end, z + .17}, {width, 0, 0}, {0, back - end, 0});
        }
        b.box(rubbed_stone, {-kNaveHalf, y, z}, {kNaveHalf, kLength, z + .17}, 3);
    }
    b.box(marble, {-1.3, 27.7, .51}, {1.3, 28.5, 1.5}, PatchBuilder::kNoBottom);
    b.box(linen, {-1.4, 27.6, 1.5}, {1.4, 28.6, 1.55});
    b.box(gold_cloth, {-.8, 27.66, .7}, {.8, 27.7, 1.5}, 63 & ~8u);
    const dvec2 candlestick[] = {{.09, 1.55},  {.09, 1.58},  {.03, 1.62},  {.025, 1.75},
                                 {.045, 1.78}, {.025, 1.81}, {.025, 1.95}, {.06, 1.98},
                                 {.06, 2.0},   {.022, 2.0},  {.022, 2.3},  {0, 2.31}};
    for (const double x : {-1.1, 1.1}) b.revolve(gilt, {x, 28.2, 0}, candlestick, 24);
    b.box(gilt, {-.03, 28.2, 1.55}, {.03, 28.26, 2.45}, PatchBuilder::kNoBottom);
    b.box(gilt, {-.28, 28.2, 2.05}, {.28, 28.26, 2.11});
}

/// Adds a cloth of 0.9 m by 2.7 m, hung in folds under the crown of an arch, with its width along y.
void banner(PatchBuilder& b, Finish finish, double x, double y) {
    constexpr double kTop = 6.1, kDrop = 2.7, kHalf = .45, kThick = .006;
    constexpr int kRows = 20, kColumns = 30;
    Grid surface;
    surface.close_columns = true;
    const auto add_row = [&](double down, double thick) {
        const auto place = [&](int column, double offset) {
            const double across = 2.0 * column / kColumns - 1;
            const double fold = .045 * (.3 + .7 * down) * std::sin(across * 7 + .8 * down + x);
            return dvec3(x + fold + offset, y + kHalf * across, kTop - kDrop * down);
        };
        auto& points = surface.rows.emplace_back();
        for (int column = 0; column <= kColumns; ++column) points.push_back(place(column, -thick));
        for (int column = kColumns; column >= 0; --column) points.push_back(place(column, thick));
    };
    add_row(0, 0);  // closed above and below
    for (int row = 0; row <= kRows; ++row) add_row(static_cast<double>(row) / kRows, kThick);
    add_row(1, 0);
    // Seen from above the loop turns right (first along y at low x) and the rows go down, so the air is
    // outside.
    b.grid(finish, surface);
}

void pew(PatchBuilder& b, double x, double y) {
    const double end = x + 1.4;
    b.box(wood, {x, y, .42}, {end, y + .42, .46});
    b.box(wood, {x, y - .04, .2}, {end, y, .95});
    for (const double side : {x, end - .05})
        b.box(wood, {side, y - .04, 0}, {side + .05, y + .44, .72}, PatchBuilder::kNoBottom);
}

void floor_and_furniture(PatchBuilder& b) {
    std::vector<Outline> outlines = {
        {{-kAisleOuter, 0}, {kAisleOuter, 0}, {kAisleOuter, kLength}, {-kAisleOuter, kLength}}};
    const auto cut = [&](double x0, double y0, double x1, double y1) {
        outlines.push_back({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}});
    };
    cut(-.9, 1.5, .9, 25.5);                    // under the runner
    cut(-kNaveHalf, 25.5, kNaveHalf, kLength);  // under the sanctuary
    for (const double side : {-1.0, 1.0})
        for (double y = kBay; y < kLength; y += kBay)
            cut(side * kArcadeAxis - .55, y - .55, side * kArcadeAxis + .55, y + .55);
    b.sheet(tiles, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, outlines);
    b.box(carpet, {-.9, 1.5, 0}, {.9, 25.5, .012}, PatchBuilder::kNoBottom & ~8u);
    for (int row = 0; row < 12; ++row)
        for (const double x : {-2.5, 1.1}) pew(b, x, 7 + 1.15 * row);
}

}  // namespace

SceneModel build_nave() {
    PatchBuilder b;
    floor_and_furniture(b);
    sanctuary(b);
    end_walls(b);
    constexpr std::array kCloths = {red_cloth, blue_cloth, gold_cloth};
    const int bays = static_cast<int>(kLength / kBay);
    for (int bay = 0; bay < bays; ++bay) {
        const double y = kBay * (bay + .5);
        vault(b, {0, y, kVaultSpringing}, kNaveHalf, kBay / 2, kVaultRise, .10);
        const dvec2 boss[] = {{0, -.34}, {.13, -.32}, {.22, -.26}, {.26, -.16}, {.26, 0}};
        b.revolve(gilt, {0, y, kVaultSpringing + kVaultRise}, boss, 32);
        for (const double side : {-1.0, 1.0}) {
            bay_walls(b, side, y);
            vault(b, {side * kAisleMiddle, y, kAisleSpringing}, kAisleMiddle - kAisleInner, kBay / 2,
                  kAisleRise, .06);
            banner(b, kCloths[static_cast<size_t>(bay + (side > 0 ? 0 : 1)) % kCloths.size()],
                   side * kArcadeAxis, y);
            rib(b, vault_arch({side * kNaveHalf, y, kVaultSpringing}, {0, kBay / 2, 0}, kVaultRise),
                {-1, 0, 0}, .07, .1);
        }
    }
    for (int border = 0; border <= bays; ++border) {
        const double y = kBay * border;
        rib(b, vault_arch({0, y, kVaultSpringing}, {kNaveHalf, 0, 0}, kVaultRise), {0, 1, 0}, .16, .3);
        for (const double side : {-1.0, 1.0}) {
            wall_shafts(b, side, y);
            rib(b,
                vault_arch({side * kAisleMiddle, y, kAisleSpringing}, {kAisleMiddle - kAisleInner, 0, 0},
                           kAisleRise),
                {0, 1, 0}, .11, .2);
            const double corbel = side * (kAisleOuter - .26), wall = side * kAisleOuter;
            b.box(rubbed_stone, {std::min(corbel, wall), std::max(0.0, y - .22), kAisleSpringing - .2},
                  {std::max(corbel, wall), std::min(kLength, y + .22), kAisleSpringing});
            if (border > 0 && border < bays) column(b, side * kArcadeAxis, y);
        }
    }
    return {
        b.take(),
        {{0, 3, 1.7}, {0, 11.6, 1.7}, {0, 22.2, 1.7}, {4.75, 7.5, 1.6}, {-4.75, 17.5, 1.6}, {1.9, 27.2, 2.1}},
        {-5.4, 1, 1.5},
        {5.4, 25, 1.9}};
}

}  // namespace lucarne::io
