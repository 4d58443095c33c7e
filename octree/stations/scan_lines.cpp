#include "octree/stations/scan_lines.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <glm/geometric.hpp>

namespace lucarne::octree {
namespace {

constexpr double kShortest = .1;     ///< m: deviation along a line whose direction is known
constexpr double kThickest = .05;    ///< of a line: deviation across, as a share of that along it
constexpr double kFarthest = 60;     ///< m from a station to points on the ground
constexpr double kLeastAngle = .17;  ///< sine of the angle between two lines whose crossing is known
constexpr double kCell = .25;        ///< m
constexpr size_t kLeastPairs = 24;   ///< in a cell
constexpr double kWidest = .3, kNarrowest = .03;  ///< m: distance of the first and last lines that are fitted
constexpr double kNoise = .005;                   ///< m
constexpr double kPasses = .05;                   ///< m: distance at which a line passes a station
constexpr int kRounds = 8;

std::optional<ScanLine> line_of(std::span<const glm::vec3> run, double unit) {
    glm::dvec2 sum(0.0);
    for (const glm::vec3& point : run) sum += glm::dvec2(point);
    const glm::dvec2 mean = sum / static_cast<double>(run.size());
    double xx = 0, xy = 0, yy = 0;
    for (const glm::vec3& point : run) {
        const glm::dvec2 d = unit * (glm::dvec2(point) - mean);
        xx += d.x * d.x, xy += d.x * d.y, yy += d.y * d.y;
    }
    const double half = (xx + yy) / 2, root = std::hypot((xx - yy) / 2, xy);
    const double count = static_cast<double>(run.size());
    const double length = std::sqrt((half + root) / count),
                 width = std::sqrt(std::max(0.0, half - root) / count);
    if (!(length > kShortest && width < kThickest * length && std::isfinite(length))) return std::nullopt;
    const double angle = std::atan2(2 * xy, xx - yy) / 2;
    return ScanLine{
        .centre = unit * mean, .along = {std::cos(angle), std::sin(angle)}, .error = width / length};
}

}  // namespace

std::vector<ScanLine> scan_lines(const ScanRuns& runs, double metres_per_unit) {
    std::vector<ScanLine> lines;
    for (size_t run = 0; run < runs.count(); ++run)
        if (auto line = line_of(runs.run(run), metres_per_unit)) {
            line->run = static_cast<uint32_t>(run);
            lines.push_back(*line);
        }
    return lines;
}

bool passes(const ScanLine& line, const glm::dvec2& place) {
    const double distance = glm::length(line.centre - place);
    const double reached = std::min(kWidest, std::max(kPasses, 2 * line.error * distance));
    return distance < kFarthest && std::abs(glm::dot(line.across(), line.centre - place)) < reached;
}

size_t direction_of(const ScanLine& line, size_t count) {
    const double turn = std::atan2(line.along.y, line.along.x) / M_PI + 1;  // equal for opposite directions
    return static_cast<size_t>((turn - std::floor(turn)) * static_cast<double>(count)) % count;
}

LineMeetings::LineMeetings(const std::vector<ScanLine>& lines) : lines_(lines), taken_(lines.size()) {
    // Pairs at steps of all sizes: one station's lines follow each other in the file, more or less closely.
    for (size_t step = 1, larger = 2; step < lines.size();
         std::tie(step, larger) = std::pair(larger, step + larger))
        for (size_t i = step; i < lines.size(); ++i) {
            const ScanLine &a = lines[i - step], &b = lines[i];
            const double sine = a.along.x * b.along.y - a.along.y * b.along.x;
            if (!(std::abs(sine) > kLeastAngle)) continue;
            const glm::dvec2 apart = b.centre - a.centre;
            const double way = (apart.x * b.along.y - apart.y * b.along.x) / sine;
            const glm::dvec2 place = a.centre + way * a.along;
            if (!(std::abs(way) < kFarthest && glm::length(place - b.centre) < kFarthest)) continue;
            const glm::dvec2 cell = glm::dvec2(std::floor(place.x / kCell), std::floor(place.y / kCell));
            if (!(std::max(std::abs(cell.x), std::abs(cell.y)) < 1e9)) continue;
            crossings_.push_back({static_cast<int32_t>(cell.x), static_cast<int32_t>(cell.y),
                                  static_cast<uint32_t>(i - step), static_cast<uint32_t>(i)});
        }
    std::ranges::sort(crossings_, {},
                      [](const Crossing& c) { return std::tuple(c.x, c.y, c.first, c.second); });
}

std::optional<Meeting> LineMeetings::next() {
    size_t most = 0;
    const Crossing* best = nullptr;
    for (size_t first = 0, last; first < crossings_.size(); first = last) {
        size_t pairs = 0;
        for (last = first; last < crossings_.size() && crossings_[last].x == crossings_[first].x &&
                           crossings_[last].y == crossings_[first].y;
             ++last)
            pairs += counts(crossings_[last]);
        if (pairs > most) most = pairs, best = &crossings_[first];
    }
    if (most < kLeastPairs) return std::nullopt;
    const int32_t x = best->x, y = best->y;
    for (Crossing& crossing : crossings_)
        if (std::abs(crossing.x - x) <= 1 && std::abs(crossing.y - y) <= 1) crossing.visited = true;
    return refined(kCell * (glm::dvec2(x, y) + .5));
}

void LineMeetings::take(const Meeting& meeting) {
    for (const uint32_t line : meeting.lines) taken_[line] = true;
}

/// Moves a place to where the lines around it meet: weighted least squares over lines at ever smaller
/// distances.
Meeting LineMeetings::refined(const glm::dvec2& start) const {
    glm::dvec2 place = start;
    double reach = kWidest;
    for (int round = 0; round < kRounds; ++round, reach = std::max(kNarrowest, reach / 1.5)) {
        double xx = 0, xy = 0, yy = 0, x = 0, y = 0;
        for (size_t i = 0; i < lines_.size(); ++i) {
            const ScanLine& line = lines_[i];
            const glm::dvec2 across = line.across();
            const double offset = glm::dot(across, line.centre - place),
                         distance = glm::length(line.centre - place);
            if (taken_[i] || !(std::abs(offset) < reach && distance < kFarthest)) continue;
            const double deviation = line.error * distance + kNoise, weight = 1 / (deviation * deviation);
            xx += weight * across.x * across.x;
            xy += weight * across.x * across.y;
            yy += weight * across.y * across.y;
            x += weight * offset * across.x;
            y += weight * offset * across.y;
        }
        const double determinant = xx * yy - xy * xy;
        if (!(determinant > 1e-9 * xx * yy)) break;
        place += glm::dvec2(yy * x - xy * y, xx * y - xy * x) / determinant;
    }
    Meeting meeting{place, {}};
    for (size_t i = 0; i < lines_.size(); ++i)
        if (!taken_[i] && passes(lines_[i], place)) meeting.lines.push_back(static_cast<uint32_t>(i));
    return meeting;
}

}  // namespace lucarne::octree
