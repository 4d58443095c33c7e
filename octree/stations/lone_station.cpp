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

constexpr size_t kPointsAsked = size_t{1} << 17, kFewestPoints = 20'000;
constexpr float kOutermost = 1e15f;  ///< m; what is farther away, infinite or not a number is left out
constexpr uint32_t kMapSide = 96;    ///< cells of the map along a face of a cube: about 1 degree
/// A point is hidden by one in its cell if it is so much farther away: a cell of a floor at a flat angle has
/// points of different distances, too.
constexpr float kBehindTimes = 1.2f, kBehindBy = 0.1f;                      ///< m
constexpr float kLeastHeight = 1, kMostHeight = 2.6f, kHeightStep = 0.05f;  ///< over the floor, m
constexpr std::array kSearchSteps = {0.1f, 0.05f, 0.02f, 0.01f};  ///< of the search around the best height, m
constexpr int kMostRounds = 50;                                   ///< with each of these
/// Share of the points that are hidden from the station, at most: those beside silhouettes. Elsewhere it is
/// larger: so many times, and by so much, at this distance in any direction, m.
constexpr double kMostHidden = 0.03, kRise = 1.5, kRiseBy = 0.001;
constexpr float kElsewhere = 0.3f;

class HiddenPoints {
 public:
    explicit HiddenPoints(std::span<const glm::vec3> points) {
        const size_t step = std::max<size_t>(1, points.size() / kPointsAsked);
        for (size_t i = 0; i < points.size(); i += step)
            if (glm::all(glm::lessThan(glm::abs(points[i]), glm::vec3(kOutermost))))
                points_.push_back(points[i]);
        ranges_.resize(points_.size());
        cells_.resize(points_.size());
        nearest_.resize(size_t{6} * kMapSide * kMapSide);
    }

    size_t count() const { return points_.size(); }
    /// Returns the share of the points that others hide from a place.
    double share(const glm::vec3& place) {
        std::ranges::fill(nearest_, HUGE_VALF);
        for (size_t i = 0; i < points_.size(); ++i) {
            const glm::vec3 to = points_[i] - place;
            ranges_[i] = glm::length(to);
            cells_[i] = static_cast<uint32_t>(cube_map_cell(to, kMapSide));
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
};

constexpr std::array<glm::vec3, 6> kSixWays = {
    {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

}  // namespace

std::optional<glm::vec3> find_lone_station(std::span<const glm::vec3> points, const glm::vec3& below) {
    if (points.size() < kFewestPoints) return std::nullopt;
    HiddenPoints hidden(points);
    if (hidden.count() == 0) return std::nullopt;
    glm::vec3 best = below;
    double least = 1;
    const auto try_place = [&](const glm::vec3& place) {
        const double share = hidden.share(place);
        if (share < least) least = share, best = place;
    };
    for (float height = kLeastHeight; height <= kMostHeight; height += kHeightStep)
        try_place(below + glm::vec3(0, 0, height));
    for (const float step : kSearchSteps) {
        for (int round = 0; round < kMostRounds; ++round) {
            const glm::vec3 from = best;
            for (const glm::vec3& around : kSixWays) try_place(from + step * around);
            if (best == from) break;
        }
    }
    const float height = best.z - below.z;
    if (!(least <= kMostHidden) || !(height >= kLeastHeight && height <= kMostHeight) ||
        !(glm::distance(best, below) < 2 * kMostHeight))
        return std::nullopt;
    for (const glm::vec3& around : kSixWays)
        if (!(hidden.share(best + kElsewhere * around) >= std::max(kRise * least, least + kRiseBy)))
            return std::nullopt;
    return best;
}

}  // namespace lucarne::octree
