#include "io/synthetic/albedo.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "io/core/random.h"

namespace lucarne::io {
namespace {

using glm::dvec2;
using glm::dvec3;

/// Returns a number uniform in [0, 1) for a cell of the integer lattice.
double hash_cell(int64_t x, int64_t y, int64_t z) {
    return unit_double(mix64(static_cast<uint64_t>(x) * 0x9e3779b97f4a7c15ull ^
                             static_cast<uint64_t>(y) * 0xc2b2ae3d27d4eb4full ^
                             static_cast<uint64_t>(z) * 0x165667b19e3779f9ull));
}

/// Returns value noise in [-1, 1] on the unit lattice, with smoothstep interpolation.
double noise(const dvec3& p) {
    const dvec3 cell = glm::floor(p), f = p - cell, w = f * f * (3.0 - 2.0 * f);
    const auto x = static_cast<int64_t>(cell.x), y = static_cast<int64_t>(cell.y),
               z = static_cast<int64_t>(cell.z);
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
        sum += (dx ? w.x : 1 - w.x) * (dy ? w.y : 1 - w.y) * (dz ? w.z : 1 - w.z) *
               hash_cell(x + dx, y + dy, z + dz);
    }
    return 2 * sum - 1;
}

/// Returns coordinates in a wall or floor: along the horizontal (or x) and along the vertical (or y).
dvec2 plane_coordinates(const dvec3& p, const dvec3& normal) {
    if (std::abs(normal.z) > .7) return {p.x, p.y};
    return std::abs(normal.x) > std::abs(normal.y) ? dvec2{p.y, p.z} : dvec2{p.x, p.z};
}

/// Returns 0 if a position lies in the joint of the given half width around its cell's border, otherwise 1.
double joint(double position, double cell, double half_width) {
    const double inside = position - cell * std::floor(position / cell);
    return std::min(inside, cell - inside) < half_width ? 0.0 : 1.0;
}

dvec3 ashlar(const dvec3& p, const dvec3& normal) {
    constexpr double kCourse = .42, kLength = .9, kJoint = .004;
    const dvec2 at = plane_coordinates(p, normal);
    const auto course = static_cast<int64_t>(std::floor(at.y / kCourse));
    const double along = at.x + kLength * hash_cell(course, 7, 0);
    const auto block = static_cast<int64_t>(std::floor(along / kLength));
    const double tone = .92 + .16 * hash_cell(block, course, 3), warmth = hash_cell(block, course, 4);
    const double stain = 1 + .05 * noise(p * 1.3) + .05 * noise(p * 9.0);
    const dvec3 stone = glm::mix(dvec3(.58, .53, .44), dvec3(.62, .54, .42), warmth) * tone * stain;
    const double mortar = joint(at.y, kCourse, kJoint) * joint(along, kLength, kJoint);
    return glm::mix(dvec3(.44, .41, .36), stone, mortar);
}

dvec3 tiles(const dvec3& p) {
    constexpr double kSide = .6, kJoint = .003;
    const double a = (p.x + p.y) * M_SQRT1_2, b = (p.x - p.y) * M_SQRT1_2;
    const auto i = static_cast<int64_t>(std::floor(a / kSide)),
               j = static_cast<int64_t>(std::floor(b / kSide));
    const double tone = .93 + .14 * hash_cell(i, j, 11);
    const double vein =
        1 + .10 * noise(p * 3.0 + dvec3(0, 0, 5.0 * hash_cell(i, j, 12))) + .05 * noise(p * 14.0);
    const bool dark = ((i + j) & 1) != 0;
    const dvec3 tile = (dark ? dvec3(.17, .16, .16) : dvec3(.66, .61, .52)) * tone * vein;
    return glm::mix(dvec3(.30, .28, .25), tile, joint(a, kSide, kJoint) * joint(b, kSide, kJoint));
}

dvec3 slabs(const dvec3& p) {
    constexpr double kSide = 1.0, kJoint = .004;
    const auto i = static_cast<int64_t>(std::floor(p.x / kSide)),
               j = static_cast<int64_t>(std::floor(p.y / kSide));
    const dvec3 slab = dvec3(.56, .54, .50) * (.9 + .2 * hash_cell(i, j, 21)) * (1 + .06 * noise(p * 4.0));
    return glm::mix(dvec3(.32, .31, .29), slab, joint(p.x, kSide, kJoint) * joint(p.y, kSide, kJoint));
}

dvec3 wood_grain(const dvec3& p, const dvec3& base) {
    return base * (1 + .12 * noise(dvec3(p.x * 3, p.y * 3, p.z * 40)) +
                   .10 * noise(dvec3(p.x * 25, p.y * 4, p.z * 4)));
}

dvec3 boards(const dvec3& p) {
    constexpr double kWidth = .14, kJoint = .002;
    const auto board = static_cast<int64_t>(std::floor(p.x / kWidth));
    const double grain = 1 + .12 * noise(dvec3(p.x * 60, p.y * 2, static_cast<double>(board)));
    const dvec3 wood = dvec3(.46, .30, .17) * (.8 + .4 * hash_cell(board, 31, 0)) * grain;
    return glm::mix(dvec3(.16, .10, .06), wood, joint(p.x, kWidth, kJoint));
}

dvec3 cloth(const dvec3& p, const dvec3& base) {
    return base * (1 + .06 * noise(p * 60.0) + .05 * noise(p * 4.0));
}

dvec3 carpet(const dvec3& p) {
    // A red runner with a gold line along either side. It lies along y, centred on x = 0.
    const double side = std::abs(p.x);
    const bool line = (side > .72 && side < .78) || (side > .84 && side < .86);
    return cloth(p, line ? dvec3(.62, .42, .12) : dvec3(.55, .035, .04));
}

}  // namespace

dvec3 albedo_at(Finish finish, const dvec3& p, const dvec3& normal) {
    dvec3 value(0);
    switch (finish) {
        case Finish::white:
            value = dvec3(.725, .71, .68);
            break;
        case Finish::red:
            value = dvec3(.63, .065, .05);
            break;
        case Finish::green:
            value = dvec3(.14, .45, .091);
            break;
        case Finish::half:
            value = dvec3(.5);
            break;
        case Finish::ashlar:
            value = ashlar(p, normal);
            break;
        case Finish::rubbed_stone:
            value = dvec3(.60, .55, .46) * (1 + .05 * noise(p * 2.0) + .04 * noise(p * 12.0));
            break;
        case Finish::plaster:
            value = dvec3(.74, .71, .64) * (1 + .04 * noise(p * 1.1) + .03 * noise(p * 6.0));
            break;
        case Finish::tiles:
            value = tiles(p);
            break;
        case Finish::slabs:
            value = slabs(p);
            break;
        case Finish::boards:
            value = boards(p);
            break;
        case Finish::wood:
            value = wood_grain(p, dvec3(.30, .17, .085));
            break;
        case Finish::carpet:
            value = carpet(p);
            break;
        case Finish::red_cloth:
            value = cloth(p, dvec3(.60, .04, .05));
            break;
        case Finish::blue_cloth:
            value = cloth(p, dvec3(.06, .13, .48));
            break;
        case Finish::gold_cloth:
            value = cloth(p, dvec3(.68, .45, .10));
            break;
        case Finish::linen:
            value = cloth(p, dvec3(.82, .80, .74));
            break;
        case Finish::ochre:
            value = dvec3(.66, .44, .16) * (1 + .03 * noise(p * 3.0));
            break;
        case Finish::teal:
            value = dvec3(.10, .36, .40) * (1 + .03 * noise(p * 3.0));
            break;
        case Finish::gilt:
            value = dvec3(.72, .52, .20);
            break;
        case Finish::marble:
            value = dvec3(.80, .78, .75) * (1 + .05 * noise(p * 5.0 + 2.0 * noise(p * 3.0)));
            break;
    }
    return glm::clamp(value, dvec3(.01), dvec3(.95));
}

bool albedo_varies(Finish finish) {
    constexpr std::array kOfOneColour = {Finish::white, Finish::red, Finish::green, Finish::half,
                                         Finish::gilt};
    return std::find(kOfOneColour.begin(), kOfOneColour.end(), finish) == kOfOneColour.end();
}

uint8_t srgb_code(double linear) {
    // Linear values at which the code changes: exact, and without calling pow for each point.
    static const auto kThresholds = [] {
        std::array<double, 255> table{};
        for (int code = 0; code < 255; ++code) {
            const double encoded = (code + .5) / 255;
            table[static_cast<size_t>(code)] =
                encoded <= .04045 ? encoded / 12.92 : std::pow((encoded + .055) / 1.055, 2.4);
        }
        return table;
    }();
    return static_cast<uint8_t>(std::upper_bound(kThresholds.begin(), kThresholds.end(), linear) -
                                kThresholds.begin());
}

}  // namespace lucarne::io
