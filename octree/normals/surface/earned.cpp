#include "octree/normals/surface/earned.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

#include "octree/tree/footprint.h"

namespace lucarne::octree {
namespace {

/// A crowd holds that many times the points of a sheet of discs of the disc's size.
constexpr float kCrowd = 3.0f;
/// Points up to so many radii of the disc over its plane lie in it.
constexpr float kInRadii = 0.08f;
/// Least share of the crowd that lies in the disc's plane. Of discs of two real rooms that are twice as wide
/// as those around them, most of those in the air have a share below .3, and those on walls over .7. In a
/// corner between walls of one density it is .5.
constexpr float kLeastFlat = 0.45f;
/// A crowd beside the disc may be another surface, such as a dense floor below a sparse wall. Then the disc's
/// own surface goes on away from it: this share of the points there, and at least so many, lie in its plane.
/// A sheet has 14 on one side.
constexpr float kLeastAway = 0.7f;
constexpr size_t kFewestAway = 5;

/// Counts the points of a crowd.
struct Count {
    size_t all = 0, flat = 0;
    float share() const { return all > 0 ? static_cast<float>(flat) / static_cast<float>(all) : 1.0f; }
};

}  // namespace

float earned_area(const Tile& around, const glm::vec3& centre, float known, const WideDisc& disc) {
    const float look2 = std::min(known * known, kEarnedLook * kEarnedLook * disc.radius * disc.radius);
    const float level = kInRadii * disc.radius;
    const auto each = [&](const auto& use) {
        for (size_t i = 0; i < around.count; ++i) {
            const glm::vec3 p = glm::vec3(around.x[i], around.y[i], around.z[i]) - centre;
            if (glm::dot(p, p) <= look2) use(p, std::abs(glm::dot(p, disc.normal)) <= level);
        }
    };
    Count crowd, away;
    glm::vec3 sum(0.0f);
    each([&](const glm::vec3& p, bool flat) {
        ++crowd.all;
        crowd.flat += flat;
        sum += p;
    });
    const auto points = static_cast<float>(crowd.all);
    const float sheet = kCoverageRaw * look2 / (disc.radius * disc.radius);
    constexpr float kAny = std::numeric_limits<float>::infinity();
    if (points < kCrowd * sheet || crowd.share() >= kLeastFlat) return kAny;
    each([&](const glm::vec3& p, bool flat) {
        if (glm::dot(p, sum) >= 0) return;
        ++away.all;
        away.flat += flat;
    });
    if (away.flat >= kFewestAway && away.share() >= kLeastAway) return kAny;
    return std::numbers::pi_v<float> * look2 / points;
}

}  // namespace lucarne::octree
