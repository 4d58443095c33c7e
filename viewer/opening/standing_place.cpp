#include "viewer/opening/standing_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "io/core/parallel.h"

namespace lucarne::viewer {
namespace {

// Lengths in metres.
constexpr double kEyeHeight = 1.6;
constexpr double kLeastHeight = 1.9;  ///< free height for a person to stand
constexpr double kWideEnough = 2;     ///< distance to the nearest wall from which a place gets no better
constexpr double kElbowRoom = 0.7;    ///< distance to what stands beside and behind the eye
constexpr double kHeadRoom = 0.3;     ///< distance to what is above the eye
constexpr double kClear = 1.2;        ///< distance to the nearest thing in a picture that fills no part of it
/// Half of the width and the height of a picture's middle, in distances from the eye.
constexpr glm::dvec2 kHalfPicture{.6, .6};
constexpr double kSameFloor = 0.3;  ///< difference in height of places on one floor
constexpr double kLampSpacing = 5;
constexpr double kHighestLamp = 4;                  ///< above the floor
constexpr double kLeastAway = .4, kMostAway = 1.5;  ///< of grazing light from its wall

constexpr double kLitHeight = .3;                    ///< above the floor, where the sun should arrive
constexpr double kFloorInView = 3;                   ///< distance from which level pictures show the floor
constexpr double kLowestSun = 20, kHighestSun = 50;  ///< degrees
constexpr double kSunStep = 5;                       ///< degrees

/// Share of the floor that a window lights; gaps between points light less.
constexpr double kLeastOpen = .05;

constexpr size_t kMostPlaces = 3000;  ///< places to stand that are examined
constexpr size_t kPlacesPerTask = 64;
constexpr int kAzimuths = 24;
constexpr size_t kViews = 16;                                ///< that are compared
constexpr double kBetweenViews = 1.5;                        ///< distance between their places, at least
constexpr double kWorthAView = .5;                           ///< share of the best score
constexpr double kStepBack = .2;                             ///< length of a step, at least
constexpr double kNearlyAsGood = .85;                        ///< share of the most space ahead
constexpr double kNearlyAsFull = 1 / 1.5;                    ///< share of the most that a picture shows
constexpr double kLowestStation = 1, kHighestStation = 2.6;  ///< over the floor
constexpr double kFloorAround = 1.5;  ///< distance to a place to stand; there are no points below a tripod
constexpr size_t kMostStations = 64;  ///< that are tried; of more, every second, third and so on
constexpr double kLeastOfFloor = .5;  ///< share of the size of the floor from which most is seen
constexpr glm::dvec2 kPreferred{.8, .6};  ///< along no wall of most rooms
constexpr double kWalled = .8;            ///< share of blocked directions from which a place is in a room
constexpr size_t kMostLamps = 3;

glm::dvec3 direction(double azimuth, double elevation) {
    return {std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
            std::sin(elevation)};
}
double azimuth_of(double i) {
    return 2 * std::numbers::pi * i / kAzimuths;
}

struct Place {
    glm::dvec3 eye;
    double floor, ceiling;
};

/// Returns the places to stand above the cells of one column.
void stand_in_column(const OccupancyGrid& grid, int x, int y, double metre, std::vector<Place>& places) {
    const glm::ivec3 size = grid.size();
    for (int z = 0; z < size.z; ++z) {
        if (!grid.occupied({x, y, z}) || grid.occupied({x, y, z + 1})) continue;
        const double floor = grid.middle({x, y, z}).z;
        int above = z + 1;
        while (above < size.z && !grid.occupied({x, y, above})) ++above;
        const double ceiling = grid.middle({x, y, above}).z;
        const bool high_enough = ceiling - floor >= kLeastHeight * metre || above == size.z;
        const double top = grid.middle({x, y, size.z}).z - grid.cell() / 2;
        if (high_enough && floor + kEyeHeight * metre < top) {  // else it is a roof
            const glm::dvec3 middle = grid.middle({x, y, z});
            places.push_back({{middle.x, middle.y, floor + kEyeHeight * metre}, floor, ceiling});
        }
        z = above - 1;
    }
}

std::vector<Place> places_to_stand(const OccupancyGrid& grid, double metre) {
    const glm::ivec3 size = grid.size();
    std::vector<Place> places;
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) stand_in_column(grid, x, y, metre, places);
    if (places.size() <= kMostPlaces) return places;
    std::vector<Place> some;
    for (size_t i = 0; i < kMostPlaces; ++i) some.push_back(places[i * places.size() / kMostPlaces]);
    return some;
}

/// Whether walls stand around a place, and something is above it.
bool enclosed(const OccupancyGrid& grid, const glm::dvec3& eye) {
    int around = 0, above = grid.look(eye, {0, 0, 1}).blocked;
    for (int i = 0; i < kAzimuths; ++i) {
        around += grid.look(eye, direction(azimuth_of(i), 0.1)).blocked;
        around += grid.look(eye, direction(azimuth_of(i), 0.5)).blocked;
        above += grid.look(eye, direction(azimuth_of(i), 1.0)).blocked;
    }
    return around >= kWalled * 2 * kAzimuths && above >= kWalled * (kAzimuths + 1);
}

/// The visible area around a place times the distance to the nearest thing, because every place in a convex
/// room sees the same area.
double roominess(const OccupancyGrid& grid, const glm::dvec3& eye, double metre) {
    double area = 0, nearest = kWideEnough * metre;
    for (int i = 0; i < kAzimuths; ++i) {
        const double distance = grid.look(eye, direction(azimuth_of(i), 0)).distance;
        area += distance * distance;
        nearest = std::min(nearest, distance);
    }
    return area * nearest;
}

/// What the search for a view asks.
struct Survey {
    const OccupancyGrid& grid;
    std::vector<glm::dvec3> cells;  ///< the middles of those that contain points
    double metre;                   ///< world units
};

/// The pyramid that the middle of a level picture shows.
struct Frame {
    glm::dvec3 eye, ahead;

    /// Returns the distance of what lies at a place; 0: it is not in the middle.
    double depth_of(const glm::dvec3& place) const {
        const glm::dvec3 to = place - eye;
        const double depth = dot(to, ahead), aside = to.y * ahead.x - to.x * ahead.y;
        const bool shown =
            std::abs(aside) <= kHalfPicture.x * depth && std::abs(to.z) <= kHalfPicture.y * depth;
        return shown ? depth : 0;
    }
};

/// Returns the distance to the nearest thing in the middle of a picture, at most `most`. What is low counts,
/// too: a rail or a wire closely before the eye crosses the whole picture.
double free_before(const OccupancyGrid& grid, const Frame& frame, double most) {
    const glm::dvec3 aside = kHalfPicture.x * glm::dvec3(-frame.ahead.y, frame.ahead.x, 0),
                     up(0, 0, kHalfPicture.y);
    glm::dvec3 low = frame.eye, high = frame.eye;
    for (const glm::dvec3& corner : {aside + up, aside - up, up - aside, -aside - up}) {
        low = glm::min(low, frame.eye + most * (frame.ahead + corner));
        high = glm::max(high, frame.eye + most * (frame.ahead + corner));
    }
    const glm::ivec3 middle = grid.cell_of(frame.eye), first = grid.cell_of(low), last = grid.cell_of(high);
    double nearest = most;
    for (int z = first.z; z <= last.z; ++z)
        for (int y = first.y; y <= last.y; ++y)
            for (int x = first.x; x <= last.x; ++x) {
                const glm::ivec3 at(x, y, z);
                if (at == middle || !grid.occupied(at)) continue;
                const double depth = frame.depth_of(grid.middle(at));
                if (depth > 0) nearest = std::min(nearest, depth);
            }
    return nearest;
}

/// Steps back as far as the room allows, to where nothing stands closely before the eye.
glm::dvec3 step_back(const OccupancyGrid& grid, const glm::dvec3& eye, const glm::dvec3& ahead,
                     double metre) {
    const glm::dvec3 aside(-ahead.y, ahead.x, 0);
    const double room = std::max(kElbowRoom * metre, grid.cell()),
                 step = std::max(grid.cell() / 2, kStepBack * metre);
    glm::dvec3 at = eye, clear = eye;
    for (double left = grid.look(eye, -ahead).distance - room; left > step; left -= step) {
        const glm::dvec3 next = at - ahead * step;
        if (grid.look(next, aside).distance < room || grid.look(next, -aside).distance < room) break;
        if (grid.look(next, {0, 0, 1}).distance < kHeadRoom * metre) break;
        at = next;
        if (free_before(grid, {at, ahead}, kClear * metre) == kClear * metre) clear = at;
    }
    return clear;
}

double preference(const glm::dvec3& v) {
    return v.x * kPreferred.x + v.y * kPreferred.y;
}

/// A view of a room.
struct RoomView {
    glm::dvec3 eye{0.0}, ahead{0.0};
    double space = 0;  ///< how much of it a picture shows: a score
};

/// Finds where to stand near a place, or at it (`exactly`), and the horizontal direction in which a picture
/// from there shows the most space. Most rooms are as long one way as the other: of directions that are
/// nearly as good, and show nearly as many things, one is chosen that more or other points do not change.
RoomView look_along_the_room(const Survey& survey, const glm::dvec3& near, bool exactly = false) {
    const auto& [grid, cells, metre] = survey;
    const double clear = kClear * metre;
    std::array<Frame, kAzimuths> frames;
    std::array<double, kAzimuths> space{};
    for (int i = 0; i < kAzimuths; ++i) {
        const glm::dvec3 ahead = direction(azimuth_of(i), 0);
        const glm::dvec3 eye = exactly ? near : step_back(grid, near, ahead, metre);
        frames[i] = {eye, ahead};
        // Square roots, so that a column in front outweighs the length of what is beside it.
        for (double beside = -2; beside <= 2; beside += .5)
            space[i] += std::sqrt(grid.look(eye, direction(azimuth_of(i + beside), 0)).distance);
        // A wall beside the eye fills a side of the picture, and what is closely before it the middle.
        const glm::dvec3 aside = direction(azimuth_of(i) + std::numbers::pi / 2, 0);
        const double narrow = std::min(grid.look(eye, aside).distance, grid.look(eye, -aside).distance);
        space[i] *= std::pow(std::min(narrow, kWideEnough * metre), .25);
        space[i] *= free_before(grid, frames[i], clear) / clear;
    }
    const double most = *std::ranges::max_element(space);
    const auto best_near = [&](int i) {
        for (int beside = -3; beside <= 3; ++beside)
            if (space[(i + beside + kAzimuths) % kAzimuths] > space[i]) return false;
        return true;
    };
    std::array<bool, kAzimuths> good{};
    std::array<double, kAzimuths> things{};  // in the pictures of good directions
    for (int i = 0; i < kAzimuths; ++i)
        if ((good[i] = space[i] >= kNearlyAsGood * most && best_near(i)))
            things[i] = static_cast<double>(std::ranges::count_if(
                cells, [&](const glm::dvec3& cell) { return frames[i].depth_of(cell) > 0; }));
    const double fullest = *std::ranges::max_element(things);
    RoomView best;
    for (int i = 0; i < kAzimuths; ++i) {
        const bool full = good[i] && things[i] >= kNearlyAsFull * fullest;
        if (full && (best.space == 0 || preference(frames[i].ahead) > preference(best.ahead)))
            best = {frames[i].eye, frames[i].ahead, space[i]};
    }
    return best;
}

/// Returns the numbers of the places with the best scores, best first; none is near another.
std::vector<size_t> best_places(const std::vector<Place>& places, const std::vector<double>& score,
                                double metre) {
    std::vector<size_t> order(places.size()), best;
    std::iota(order.begin(), order.end(), size_t{0});
    std::ranges::stable_sort(order, std::ranges::greater(), [&](size_t i) { return score[i]; });
    for (const size_t i : order) {
        if (best.size() == kViews || score[i] < kWorthAView * score[order.front()]) break;
        if (std::ranges::none_of(best, [&](size_t j) {
                return glm::distance(places[i].eye, places[j].eye) < kBetweenViews * metre;
            }))
            best.push_back(i);
    }
    return best;
}

/// Returns for each place the number of places on a floor of the same height.
std::vector<size_t> sizes_of_floors(const std::vector<Place>& places, double metre) {
    std::vector<double> floors;
    for (const Place& place : places) floors.push_back(place.floor);
    std::sort(floors.begin(), floors.end());
    std::vector<size_t> sizes;
    for (const Place& place : places)
        sizes.push_back(static_cast<size_t>(
            std::upper_bound(floors.begin(), floors.end(), place.floor + kSameFloor * metre) -
            std::lower_bound(floors.begin(), floors.end(), place.floor - kSameFloor * metre)));
    return sizes;
}

/// Returns the number of the place to stand that is nearest to a station and has a floor from `least` on;
/// none where the scanner did not stand on that floor as a person does.
std::optional<size_t> place_under(const glm::dvec3& station, const std::vector<Place>& places,
                                  const std::vector<size_t>& floors, double least, double metre) {
    std::optional<size_t> best;
    double nearest = kFloorAround * metre;
    for (size_t i = 0; i < places.size(); ++i) {
        const double height = (station.z - places[i].floor) / metre;
        const bool stands = height >= kLowestStation && height <= kHighestStation;  // not NaN
        if (static_cast<double>(floors[i]) < least || !stands) continue;
        const double away = glm::distance(glm::dvec2(station), glm::dvec2(places[i].eye));
        if (away < nearest) nearest = away, best = i;
    }
    return best;
}

/// A view, and the number of the place on whose floor it stands.
struct PlacedView {
    RoomView view;
    size_t under = 0;
};

/// Returns the widest view from where a scanner stood, if it is about as wide as `widest`; else that one.
PlacedView from_station(const Survey& survey, const PlacedView& widest, std::span<const glm::dvec3> stations,
                        const std::vector<Place>& places, const std::vector<size_t>& floors) {
    const double least = kLeastOfFloor * static_cast<double>(floors[widest.under]);
    struct Candidate {
        glm::dvec3 station{0.0};
        size_t under = 0;
        RoomView view;
    };
    std::vector<Candidate> candidates;
    const size_t step = (stations.size() + kMostStations - 1) / kMostStations;
    for (size_t i = 0; i < stations.size(); i += step) {
        const auto under = place_under(stations[i], places, floors, least, survey.metre);
        if (under && enclosed(survey.grid, stations[i])) candidates.push_back({stations[i], *under, {}});
    }
    parallel_ranges(candidates.size(), 1, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i)
            candidates[i].view = look_along_the_room(survey, candidates[i].station, true);
    });
    PlacedView best = widest;
    best.view.space *= kNearlyAsGood;
    bool found = false;
    for (const auto& [station, under, view] : candidates)
        if (view.space > best.view.space) best = {view, under}, found = true;
    return found ? best : widest;
}

std::vector<glm::dvec3> places_of_lamps(const OccupancyGrid& grid, const StandingPlace& place, double metre) {
    const double length = place.free_ahead;
    const auto count =
        std::clamp(static_cast<size_t>(length / (kLampSpacing * metre)), size_t{1}, kMostLamps);
    std::vector<glm::dvec3> lamps;
    for (size_t i = 0; i < count; ++i) {
        glm::dvec3 at =
            place.eye + place.ahead * (length * (static_cast<double>(i) + .5) / static_cast<double>(count));
        const double height = place.eye.z + grid.look(at, {0, 0, 1}).distance - place.floor;
        at.z = place.floor + std::min(.8 * height, kHighestLamp * metre);
        lamps.push_back(at);
    }
    return lamps;
}

/// Returns the distance from the place to the wall in a horizontal direction: the third of nine rays at three
/// heights, so that furniture does not stop all of them, and they do not all pass a window.
double wall_distance(const OccupancyGrid& grid, const StandingPlace& place, const glm::dvec3& toward,
                     double metre) {
    const double heights[3] = {place.floor + .5 * metre, place.eye.z, place.ceiling - .5 * metre};
    const double azimuth = std::atan2(toward.y, toward.x);
    std::array<double, 9> distances{};
    for (size_t i = 0; i < distances.size(); ++i) {
        const double turn = .15 * (static_cast<double>(i % 3) - 1);
        const glm::dvec3 at(place.eye.x, place.eye.y, heights[i / 3]);
        distances[i] = grid.look(at, direction(azimuth + turn, 0)).distance * std::cos(turn);
    }
    std::ranges::nth_element(distances, distances.begin() + 3);
    return std::min(distances[3], grid.look(place.eye, toward).distance);
}

/// Returns the line along the wall on the left. It begins beside the eye, where pictures do not show the
/// brightest part of the wall, as far from it as a fifth of its length.
AlongWall along_left_wall(const OccupancyGrid& grid, const StandingPlace& place, double metre) {
    const glm::dvec3 left(-place.ahead.y, place.ahead.x, 0);
    const double length = wall_distance(grid, place, place.ahead, metre);
    const double free = wall_distance(grid, place, left, metre);
    const double away = std::min(std::clamp(length / 5, kLeastAway * metre, kMostAway * metre), free);
    const glm::dvec3 from = place.eye + left * (free - away);
    return {from, from + place.ahead * length + left * (away / 2)};
}

/// Returns places near the floor along the room, where a picture from the standing place shows it.
std::vector<glm::dvec3> places_on_the_floor(const OccupancyGrid& grid, const StandingPlace& place,
                                            double metre) {
    constexpr int kAlong = 12, kAside = 5;
    const glm::dvec3 aside(-place.ahead.y, place.ahead.x, 0);
    const double height = place.floor + std::max(kLitHeight * metre, 1.5 * grid.cell());
    const double end = wall_distance(grid, place, place.ahead, metre);
    const double begin = std::min(kFloorInView * metre, end / 2);
    std::vector<glm::dvec3> places;
    for (int i = 0; i < kAlong; ++i) {
        const glm::dvec3 middle = place.eye + place.ahead * (begin + (end - begin) * (i + .5) / kAlong);
        const double left = grid.look(middle, aside).distance, right = grid.look(middle, -aside).distance;
        for (int j = 0; j < kAside; ++j) {
            glm::dvec3 at = middle + aside * (left - (left + right) * (j + .5) / kAside);
            at.z = height;
            if (grid.look(at, {0, 0, 1}).blocked) places.push_back(at);  // else it is outside
        }
    }
    return places;
}

/// Returns the direction in which most of the floor sees the sky. The least of three neighbouring azimuths
/// counts, because a gap between points is no window.
std::optional<glm::dvec3> sunward_of(const OccupancyGrid& grid, const StandingPlace& place, double metre) {
    const std::vector<glm::dvec3> places = places_on_the_floor(grid, place, metre);
    constexpr int kSunAzimuths = 3 * kAzimuths;
    const auto azimuth = [](int i) { return 2 * std::numbers::pi * i / kSunAzimuths; };
    std::optional<glm::dvec3> best;
    int most = static_cast<int>(kLeastOpen * static_cast<double>(places.size()));
    for (double height = kLowestSun; height <= kHighestSun; height += kSunStep) {
        const double elevation = height * std::numbers::pi / 180;
        std::array<int, kSunAzimuths> open{};
        for (int i = 0; i < kSunAzimuths; ++i)
            for (const glm::dvec3& at : places)
                open[i] += !grid.look(at, direction(azimuth(i), elevation)).blocked;
        for (int i = 0; i < kSunAzimuths; ++i) {
            const int light = std::min(
                {open[(i + kSunAzimuths - 1) % kSunAzimuths], open[i], open[(i + 1) % kSunAzimuths]});
            if (light > most) most = light, best = direction(azimuth(i), elevation);
        }
    }
    return best;
}

}  // namespace

Standing find_standing_place(const OccupancyGrid& grid, double metres_per_unit,
                             std::span<const glm::dvec3> stations) {
    const double metre = 1 / metres_per_unit;
    Standing found;
    if (grid.empty() || grid.cell() > kLeastHeight * metre) return found;  // cells hide rooms
    const std::vector<Place> places = places_to_stand(grid, metre);
    std::vector<std::optional<double>> scores(places.size());  // of places in rooms
    parallel_ranges(places.size(), kPlacesPerTask, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i)
            if (enclosed(grid, places[i].eye)) scores[i] = roominess(grid, places[i].eye, metre);
    });
    std::vector<Place> in_rooms;
    std::vector<double> roominess_of;
    for (size_t i = 0; i < places.size(); ++i)
        if (scores[i]) in_rooms.push_back(places[i]), roominess_of.push_back(*scores[i]);
    // From the top of a cupboard one sees more of a room, but people stand on floors, which are larger.
    const std::vector<size_t> floor = sizes_of_floors(in_rooms, metre);
    std::vector<double> score;
    for (size_t i = 0; i < in_rooms.size(); ++i)
        score.push_back(roominess_of[i] * static_cast<double>(floor[i]));
    // Of the roomiest places, the one with the widest view: no column stands before it.
    const std::vector<size_t> best = best_places(in_rooms, score, metre);
    if (best.empty()) return found;
    const Survey survey{grid, grid.occupied_middles(), metre};
    std::vector<RoomView> views(best.size());
    parallel_ranges(best.size(), 1, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) views[i] = look_along_the_room(survey, in_rooms[best[i]].eye);
    });
    const auto widest = std::ranges::max_element(views, {}, &RoomView::space);
    const auto [view, under] = from_station(
        survey, {*widest, best[static_cast<size_t>(widest - views.begin())]}, stations, in_rooms, floor);
    found.enclosed_share = static_cast<double>(in_rooms.size()) / static_cast<double>(places.size());
    StandingPlace place;
    place.eye = view.eye;
    place.ahead = view.ahead;
    place.free_ahead = grid.look(place.eye, place.ahead).distance;
    place.floor = in_rooms[under].floor;
    place.ceiling = in_rooms[under].ceiling;
    place.lamps = places_of_lamps(grid, place, metre);
    place.left_wall = along_left_wall(grid, place, metre);
    place.sunward = sunward_of(grid, place, metre);
    found.best = place;
    return found;
}

}  // namespace lucarne::viewer
