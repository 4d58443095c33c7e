// What a scanner received is what nothing hid from it, so from its place each direction shows points of one
// distance; from any other place some points hide others. This is the test of visibility of Katz, Tal and
// Basri 2007, "Direct visibility of point sets", for a place that is to be found; by a map of ranges, not by
// a hull.
#include "octree/stations/lone_station.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "octree/stations/cube_map.h"

namespace lucarne::octree {
namespace {

constexpr size_t kFewestPoints = 20'000;
constexpr float kOutermost = 1e15f;  ///< m; what is farther away, infinite or not a number is left out
/// Points that are asked, and cells of their map along a face of a cube, at most. The first search, with
/// cells of about a degree, finds the surroundings of the place for the second, with cells of half a degree.
constexpr size_t kCoarsePoints = size_t{1} << 17, kFinePoints = size_t{1} << 19;
constexpr uint32_t kCoarseSide = 96, kFineSide = 192;
constexpr double kPointsOfCell = 2.4;  ///< at least, in the mean
/// A point is hidden by one in its cell if it is so much farther away: a cell of a floor at a flat angle has
/// points of different distances, too.
constexpr float kBehindTimes = 1.2f, kBehindBy = 0.1f;                      ///< m
constexpr float kLeastHeight = 1, kMostHeight = 2.6f, kHeightStep = 0.05f;  ///< over the floor, m
constexpr std::array kCoarseSteps = {0.1f, 0.05f};                          ///< of the searches, m
constexpr std::array kFineSteps = {0.02f, 0.01f, 0.005f};
constexpr int kMostRounds = 50;  ///< with each of these
/// Share of the points that are hidden from the station, at most: those beside silhouettes. Elsewhere it is
/// larger: so many times, and by so much, at this distance in any direction, m. (Twice around the station of
/// a real room; at most 1.15 times in the flattest direction around places that are none.)
constexpr double kMostHidden = 0.03, kRise = 1.5, kRiseBy = 3e-5;
constexpr double kRisePoints = 12;  ///< and by so many points
constexpr float kElsewhere = 0.3f;

class HiddenPoints {
 public:
    /// Uses up to `most` of the points and a map of up to 6 x `side`^2 cells.
    HiddenPoints(std::span<const glm::vec3> points, size_t most, uint32_t side) {
        const size_t step = std::max<size_t>(1, (points.size() + most - 1) / most);
        for (size_t i = 0; i < points.size(); i += step)
            if (glm::all(glm::lessThan(glm::abs(points[i]), glm::vec3(kOutermost))))
                points_.push_back(points[i]);
        ranges_.resize(points_.size());
        cells_.resize(points_.size());
        const double cells = static_cast<double>(points_.size()) / kPointsOfCell;
        side_ = std::clamp(static_cast<uint32_t>(std::sqrt(cells / 6)), 1u, side);
        nearest_.resize(size_t{6} * side_ * side_);
    }

    size_t count() const { return points_.size(); }
    /// Returns the share of the points that others hide from a place.
    double share(const glm::vec3& place) {
        std::ranges::fill(nearest_, HUGE_VALF);
        for (size_t i = 0; i < points_.size(); ++i) {
            const glm::vec3 to = points_[i] - place;
            ranges_[i] = glm::length(to);
            cells_[i] = static_cast<uint32_t>(cube_map_cell(to, side_));
            nearest_[cells_[i]] = std::min(nearest_[cells_[i]], ranges_[i]);
        }
        size_t hidden = 0;
        for (size_t i = 0; i < points_.size(); ++i)
            hidden += ranges_[i] > kBehindTimes * nearest_[cells_[i]] + kBehindBy;
        return static_cast<double>(hidden) / static_cast<double>(points_.size());
    }

 private:
    std::vector<glm::vec3> points_;
    std::vector<float> ranges_, nearest_;
    std::vector<uint32_t> cells_;
    uint32_t side_ = 1;
};

constexpr std::array<glm::vec3, 6> kSixWays = {
    {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

/// The place from which the fewest points are hidden, of those that were tried.
struct TriedPlace {
    glm::vec3 at{0.0f};
    double hidden = 1;
};

void try_place(HiddenPoints& hidden, const glm::vec3& at, TriedPlace& best) {
    if (const double share = hidden.share(at); share < best.hidden) best = {at, share};
}

/// Goes from the best place to better ones beside it until there are none.
void descend(HiddenPoints& hidden, std::span<const float> steps, TriedPlace& best) {
    for (const float step : steps)
        for (int round = 0; round < kMostRounds; ++round) {
            const glm::vec3 from = best.at;
            for (const glm::vec3& around : kSixWays) try_place(hidden, from + step * around, best);
            if (best.at == from) break;
        }
}

}  // namespace

std::optional<glm::vec3> find_lone_station(std::span<const glm::vec3> points, const glm::vec3& below) {
    if (points.size() < kFewestPoints) return std::nullopt;
    HiddenPoints coarse(points, kCoarsePoints, kCoarseSide);
    if (coarse.count() == 0) return std::nullopt;
    TriedPlace best{.at = below};
    for (float height = kLeastHeight; height <= kMostHeight; height += kHeightStep)
        try_place(coarse, below + glm::vec3(0, 0, height), best);
    descend(coarse, kCoarseSteps, best);
    HiddenPoints fine(points, kFinePoints, kFineSide);
    best.hidden = fine.share(best.at);
    descend(fine, kFineSteps, best);
    const float height = best.at.z - below.z;
    if (!(best.hidden <= kMostHidden) || !(height >= kLeastHeight && height <= kMostHeight) ||
        !(glm::distance(best.at, below) < 2 * kMostHeight))
        return std::nullopt;
    const double more = best.hidden + std::max(kRiseBy, kRisePoints / static_cast<double>(fine.count()));
    for (const glm::vec3& around : kSixWays)
        if (!(fine.share(best.at + kElsewhere * around) >= std::max(kRise * best.hidden, more)))
            return std::nullopt;
    return best.at;
}

}  // namespace lucarne::octree
