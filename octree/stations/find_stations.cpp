#include "octree/stations/find_stations.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <limits>
#include <optional>

#include <glm/geometric.hpp>

#include "octree/stations/scan_lines.h"

namespace lucarne::octree {
namespace {

constexpr size_t kLeastLines = 40;      ///< of a station
constexpr size_t kDirections = 18;      ///< of lines, 10 degrees each
constexpr size_t kLeastDirections = 7;  ///< walls and streets have two or three; a facade's station has eight
/// m between stations. A leaning scanner's profiles meet in a ring around it, which is no further station.
constexpr double kApart = 1;
constexpr int kMostPlaces = 128;  ///< that are looked at
constexpr size_t kMostProfiles = 256;
constexpr double kBelow = 1, kAbove = 10;    ///< m: how far beyond its points a station's height is searched
constexpr double kHighest = 60;              ///< m: range of heights that are searched
constexpr double kCoarse = .1, kFine = .01;  ///< m: steps of the height
constexpr double kLargestSpread = .35;       ///< of equal steps; thinned at random .25, noise over .5
constexpr double kLeastStep = 1e-6;          ///< radians; from within their own plane, points have none
constexpr double kBeside = 1, kLeastRise = 1.5;  ///< m; by how much the spread must grow there

/// A run in the vertical plane of its line: horizontal distances from the station, and heights.
struct Profile {
    std::array<double, ScanRuns::kRunPoints> across, height;
};

std::vector<Profile> profiles(const ScanRuns& runs, const std::vector<ScanLine>& lines,
                              const Meeting& meeting, double unit) {
    std::vector<Profile> all;
    const size_t step = (meeting.lines.size() + kMostProfiles - 1) / kMostProfiles;
    for (size_t i = 0; i < meeting.lines.size(); i += step) {
        const ScanLine& line = lines[meeting.lines[i]];
        Profile profile;
        for (size_t at = 0; at < ScanRuns::kRunPoints; ++at) {
            const glm::dvec3 point = unit * glm::dvec3(runs.run(line.run)[at]);
            profile.across[at] = glm::dot(glm::dvec2(point) - meeting.place, line.along);
            profile.height[at] = point.z;
        }
        all.push_back(profile);
    }
    return all;
}

/// Returns the logarithm of the median angle between successive points, seen from a height.
double step_of(const Profile& profile, double height) {
    std::array<double, ScanRuns::kRunPoints - 1> steps;
    for (size_t i = 0; i < steps.size(); ++i) {
        const glm::dvec2 a(profile.across[i], profile.height[i] - height),
            b(profile.across[i + 1], profile.height[i + 1] - height);
        const double cross = a.x * b.y - a.y * b.x;
        steps[i] = cross * cross / (glm::dot(a, a) * glm::dot(b, b) + 1e-30);
    }
    const auto middle = steps.begin() + steps.size() / 2;
    std::nth_element(steps.begin(), middle, steps.end());
    return std::log(std::max(*middle, 1e-30)) / 2;
}

/// Returns the interquartile range of the profiles' angular steps, as logarithms: 0 where all are equal,
/// infinity where a scanner would have no steps.
double spread_at(const std::vector<Profile>& profiles, double height) {
    std::vector<double> steps;
    steps.reserve(profiles.size());
    for (const Profile& profile : profiles) steps.push_back(step_of(profile, height));
    std::ranges::sort(steps);
    const double lower = steps[steps.size() / 4];
    if (!(lower > std::log(kLeastStep))) return std::numeric_limits<double>::infinity();
    return steps[steps.size() * 3 / 4] - lower;
}

/// Returns the height from which the angles between successive points are all the same. Empty: there is none.
std::optional<double> height_of(const std::vector<Profile>& profiles) {
    double low = profiles.front().height.front(), high = low;
    for (const Profile& profile : profiles)
        for (const double height : profile.height) low = std::min(low, height), high = std::max(high, height);
    low -= kBelow;
    high = std::min(high + kAbove, low + kHighest);
    double best = low, least = spread_at(profiles, low);
    const auto search = [&](double from, double to, double step) {
        const auto count = static_cast<int>(std::round((to - from) / step));
        for (int i = 0; i <= count; ++i) {
            const double height = from + step * i, spread = spread_at(profiles, height);
            if (spread < least) least = spread, best = height;
        }
    };
    search(low, high, kCoarse);
    search(best - kCoarse, best + kCoarse, kFine);
    if (!(least < kLargestSpread)) return std::nullopt;
    for (const double beside : {-kBeside, kBeside})
        if (!(spread_at(profiles, best + beside) > kLeastRise * least)) return std::nullopt;
    return best;
}

bool from_all_around(const std::vector<ScanLine>& lines, const Meeting& meeting) {
    std::bitset<kDirections> seen;
    for (const uint32_t line : meeting.lines) seen.set(direction_of(lines[line], kDirections));
    return seen.count() >= kLeastDirections;
}

}  // namespace

std::vector<glm::dvec3> find_stations(const ScanRuns& runs, double metres_per_unit) {
    std::vector<glm::dvec3> found;
    const auto lines = scan_lines(runs, metres_per_unit);
    LineMeetings meetings(lines);
    for (int place = 0; place < kMostPlaces && found.size() < kMostFoundStations; ++place) {
        const auto meeting = meetings.next();
        if (!meeting) break;
        if (meeting->lines.size() < kLeastLines || !from_all_around(lines, *meeting)) continue;
        const glm::dvec3 above = runs.origin() + glm::dvec3(meeting->place, 0) / metres_per_unit;
        const auto beside = [&](const glm::dvec3& station) {
            return metres_per_unit * glm::length(glm::dvec2(station - above)) < kApart;
        };
        if (std::ranges::any_of(found, beside)) continue;
        const auto height = height_of(profiles(runs, lines, *meeting, metres_per_unit));
        if (!height) continue;
        found.push_back(above + glm::dvec3(0, 0, *height / metres_per_unit));
        meetings.take(*meeting);
    }
    return found;
}

}  // namespace lucarne::octree
