#include "octree/normals/surface/border.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

#include "octree/normals/surface/surface_share.h"

namespace lucarne::octree {
namespace {

// Lengths are in spacings.
constexpr float kBeside = 2.5f;  ///< points up to so far along the border decide where it is
constexpr float kLook = 3.5f;    ///< a surface that goes on no farther than this has no border
/// What looks like a border beside air is a hole if the surface goes on beyond it within this. Its rim keeps
/// whole discs, which close it as far as they reach.
constexpr float kGap = 10.0f;
/// A floor below a board crosses the board's plane but does not continue it: more points beyond lie beside
/// the plane than in it, and those in it along a line, so not farther apart across it than kSheet. Of leaves
/// this says nothing: the points that belong to the surface lie up to kFlat over the plane.
constexpr float kSheet = 2.5f, kFlat = 0.5f;
constexpr float kBelow = 2.0f;  ///< and so far inside
/// The border lies so far outside the line over the outermost points. That line lies over the outermost of
/// several points, which is nearer to the end of the surface than half a spacing.
constexpr float kOutside = 0.375f;
constexpr float kFarthest = 2.0f;                           ///< lines farther from the point are of no use
constexpr float kOthersAhead = 2.5f, kOthersBehind = 1.5f;  ///< of the line: where other surfaces count
constexpr float kOthersHeight = 3.0f;
constexpr float kAhead = 1.0f;  ///< another surface that begins so far beyond the line goes on from this one
constexpr int kFewOthers = 2;   ///< as many points of another surface may be noise
constexpr float kSteepest = 1.0f;  ///< the border turns by at most 45 degrees from what `outward` says
constexpr int kSteps = 12;         ///< of the search for its direction
constexpr size_t kMostHull = 128;  ///< points that decide; where there are more, the spacing says little

/// Places of points in the tangent plane: toward the border and along it.
struct RimPlace {
    float out, along;
};

}  // namespace

std::optional<Border> find_border(const Tile& around, const glm::vec3& centre, const Rim& rim) {
    const glm::vec3 &out = rim.outward, n = rim.frame.normal, along = glm::cross(n, out);
    const float spacing = rim.spacing;
    std::array<RimPlace, kMostHull> hull;
    size_t count = 0;
    for (size_t i = 0; i < around.count; ++i) {
        const glm::vec3 p = glm::vec3(around.x[i], around.y[i], around.z[i]) - centre;
        const float v = glm::dot(along, p), u = glm::dot(out, p), h = std::abs(glm::dot(n, p));
        if (std::abs(v) > kBeside * spacing || u < -kBelow * spacing || u > kLook * spacing) continue;
        if (h > rim.level && h * h > kSlope2 * (u * u + v * v)) continue;
        if (count == kMostHull) return std::nullopt;
        hull[count++] = {u, v};
    }
    // The height of the lowest line over all points with this slope, at the point. It is convex in the slope.
    const auto height = [&](float slope) {
        float most = 0;
        for (size_t i = 0; i < count; ++i) most = std::max(most, hull[i].out - slope * hull[i].along);
        return most;
    };
    float low = -kSteepest, high = kSteepest;
    for (int step = 0; step < kSteps; ++step) {
        const float lower = low + (high - low) / 3, upper = high - (high - low) / 3;
        if (height(lower) < height(upper))
            high = upper;
        else
            low = lower;
    }
    const float slope = (low + high) / 2, at = height(slope), size = std::sqrt(1 + slope * slope);
    Border border;
    border.toward = (out - slope * along) / size;
    const float outermost = at / size;
    border.distance = outermost + kOutside * spacing;
    if (border.distance > kFarthest * spacing) return std::nullopt;

    int before = 0, behind = 0, further = 0, crossing = 0;
    float flat_from = kGap * spacing, flat_to = 0;  // where points beyond lie in the plane
    for (size_t i = 0; i < around.count; ++i) {
        const glm::vec3 p = glm::vec3(around.x[i], around.y[i], around.z[i]) - centre;
        const float u = glm::dot(border.toward, p) - outermost, v = glm::dot(along, p), h = glm::dot(n, p);
        if (std::abs(v) > kBeside * spacing || u < -kOthersBehind * spacing || u > kGap * spacing) continue;
        const glm::vec3 flat = p - n * h;
        if (std::abs(h) <= rim.level || h * h <= kSlope2 * glm::dot(flat, flat)) {
            if (u <= kLook * spacing) continue;
            ++further;
            if (std::abs(h) > rim.level) continue;
            flat_from = std::min(flat_from, u);
            flat_to = std::max(flat_to, u);
            continue;
        }
        crossing += u > kLook * spacing && std::abs(h) < u;
        if (u > kOthersAhead * spacing || std::abs(h) > kOthersHeight * spacing) continue;
        if (u > kAhead * spacing) return std::nullopt;
        ++(h > 0 ? before : behind);
    }
    if (before > kFewOthers && behind > kFewOthers) return std::nullopt;
    border.beyond = before > kFewOthers   ? Beyond::rises
                    : behind > kFewOthers ? Beyond::falls
                                          : Beyond::nothing;
    const bool crosses =
        rim.level < kFlat * spacing && further < crossing && flat_to - flat_from < kSheet * spacing;
    if (further > 0 && !crosses && border.beyond == Beyond::nothing) return std::nullopt;
    return border;
}

}  // namespace lucarne::octree
