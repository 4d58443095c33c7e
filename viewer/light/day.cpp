#include "viewer/light/day.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "viewer/opening/moods.h"

namespace lucarne::viewer {
namespace {

constexpr int kDay = 86400, kTenMinutes = 600;  ///< s
constexpr double kFilm = 1800;                  ///< seconds of the day in one of the film
constexpr double kLongestStep = .25;  ///< s of the film: after a pause of the window the sun does not leap

gi::SunMoment at_second(const gi::SunMoment& moment, int second) {
    gi::SunMoment result = moment;
    gi::LocalTime time = gi::local_time(moment.time);
    time.seconds = second;
    result.time = gi::moment_of(time, moment.time.ahead);
    return result;
}

}  // namespace

SunOnDial on_dial(const gi::SunMoment& moment) {
    const gi::SolarPosition sun = gi::solar_position(moment);
    const double azimuth = sun.azimuth * std::numbers::pi / 180, radius = (90 - sun.elevation) / 90;
    return {moment, {radius * std::sin(azimuth), -radius * std::cos(azimuth)}, sun.elevation};
}

std::vector<SunOnDial> day_on_dial(const gi::SunMoment& moment) {
    std::vector<SunOnDial> day;
    for (int second = 0; second < kDay; second += kTenMinutes)
        day.push_back(on_dial(at_second(moment, second)));
    return day;
}

const SunOnDial* nearest_on_dial(const std::vector<SunOnDial>& day, const glm::dvec2& place) {
    const auto nearest = std::ranges::min_element(
        day, {}, [&](const SunOnDial& sun) { return glm::distance(sun.place, place); });
    return nearest == day.end() ? nullptr : &*nearest;
}

std::optional<gi::SunMoment> later_that_day(const gi::SunMoment& moment, int seconds) {
    int second = (gi::local_time(moment.time).seconds + seconds) % kDay;
    for (int skipped = 0; skipped <= kDay; skipped += kTenMinutes) {
        const gi::SunMoment later = at_second(moment, second);
        if (gi::solar_position(later).elevation >= -kNight) return later;
        second = (second + kTenMinutes) % kDay;
    }
    return std::nullopt;
}

const gi::SceneLight* first_sun(const gi::Scene& scene) {
    const auto sun = std::ranges::find(scene.lights, gi::LightKind::directional, &gi::SceneLight::kind);
    return sun == scene.lights.end() ? nullptr : &*sun;
}

std::optional<gi::SunMoment> moment_of_sun(const gi::Scene& scene) {
    const gi::SceneLight* sun = first_sun(scene);
    return sun ? std::optional(sun->sun.value_or(gi::SunMoment{})) : std::nullopt;
}

void play_day(const Lighting& model) {
    model.lights.plays_day = !model.lights.plays_day && moment_of_sun(model.view.scene);
}

void advance_day(const Lighting& model, double seconds) {
    if (!model.lights.plays_day) return;
    model.lights.plays_day = false;
    const auto now = moment_of_sun(model.view.scene);
    if (!now) return;
    const auto later =
        later_that_day(*now, static_cast<int>(std::lround(kFilm * std::min(seconds, kLongestStep))));
    if (!later) {
        model.view.message = "The sun does not rise on this day";
        return;
    }
    model.lights.plays_day = true;
    set_daytime(model.view.scene, *later);
    model.view.scene_changed();
}

}  // namespace lucarne::viewer
