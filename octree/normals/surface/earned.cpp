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
/// The same for doubtful discs.
constexpr float kDoubtfulCrowd = 1.2f, kDoubtfulFlat = 0.6f;
/// Around a sparse disc without a crowd, points up to so many radii of the disc over its plane lie in it, and
/// least share of them: the points of a sheet with noise do, and .4 at the corner of a box; of points that
/// are scattered in all directions, .19 do.
constexpr float kNearRadii = 0.25f, kLeastNear = 0.3f;
/// Fewer points around a disc say nothing.
constexpr size_t kFewestScattered = 8;
/// A crowd beside the disc may be another surface, such as a dense floor below a sparse wall. Then the disc's
/// own surface goes on away from it: this share of the points there lie in its plane, and at least so many of
/// those that a sheet has on one side.
constexpr float kLeastAway = 0.7f, kLeastOfSheet = 0.5f;
constexpr size_t kFewestAway = 5;
/// The disc of a point that has not earned its size reaches so far toward the nearest other point.
constexpr float kLoneReach = 0.5f;

/// Counts the points of a crowd.
struct Count {
    size_t all = 0, flat = 0;
    float share() const { return all > 0 ? static_cast<float>(flat) / static_cast<float>(all) : 1.0f; }
};

}  // namespace

float lone_area(float nearest2) {
    return std::numbers::pi_v<float> / kCoverageRaw * nearest2;
}

float earned_area(const Tile& around, const glm::vec3& centre, float look, const WideDisc& disc) {
    const float look2 = look * look;
    const float level = kInRadii * disc.radius;
    const auto each = [&](const auto& use) {
        for (size_t i = 0; i < around.count; ++i) {
            const glm::vec3 p = glm::vec3(around.x[i], around.y[i], around.z[i]) - centre;
            if (glm::dot(p, p) <= look2) use(p, std::abs(glm::dot(p, disc.normal)));
        }
    };
    Count crowd, near, away;
    glm::vec3 sum(0.0f);
    constexpr float kAny = std::numeric_limits<float>::infinity();
    float nearest2 = kAny;
    each([&](const glm::vec3& p, float height) {
        ++crowd.all;
        crowd.flat += height <= level;
        near.flat += height <= kNearRadii * disc.radius;
        sum += p;
        const float distance2 = glm::dot(p, p);
        if (distance2 > 0) nearest2 = std::min(nearest2, distance2);
    });
    near.all = crowd.all;
    const auto points = static_cast<float>(crowd.all);
    const float sheet = kCoverageRaw * look2 / (disc.radius * disc.radius);
    const bool lone = disc.sparse || disc.doubtful;
    const float alone = lone ? lone_area(kLoneReach * kLoneReach * nearest2) : kAny;
    if (points < (disc.doubtful ? kDoubtfulCrowd : kCrowd) * sheet)
        return crowd.all >= kFewestScattered && near.share() < kLeastNear ? alone : kAny;
    if (crowd.share() >= (disc.doubtful ? kDoubtfulFlat : kLeastFlat)) return kAny;
    each([&](const glm::vec3& p, float height) {
        if (glm::dot(p, sum) >= 0) return;
        ++away.all;
        away.flat += height <= level;
    });
    const bool goes_on =
        away.flat >= kFewestAway && static_cast<float>(away.flat) >= kLeastOfSheet * sheet / 2;
    if (goes_on && away.share() >= kLeastAway) return kAny;
    return std::min(alone, std::numbers::pi_v<float> * look2 / points);
}

}  // namespace lucarne::octree
