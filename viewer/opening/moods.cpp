#include "viewer/opening/moods.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "gi/registry.h"
#include "gi/scene/photometry.h"
#include "gi/scene/scene_lights.h"
#include "gi/scene/sky_model.h"
#include "io/core/options.h"

namespace lucarne::viewer {
namespace {

constexpr std::array kMoods = {
    MoodInfo{Mood::scan_colours, "scan-colours", "Scan colours",
             "the points' own colours, with ambient occlusion"},
    MoodInfo{Mood::daylight, "daylight", "Daylight", "sun and sky"},
    MoodInfo{Mood::evening, "evening", "Evening", "warm lamps in rooms, a low sun outside"},
    MoodInfo{Mood::raking_light, "raking-light", "Raking light", "grazing light, which shows relief"},
    MoodInfo{Mood::museum, "museum", "Museum", "spots from above, before a dark background"},
    MoodInfo{Mood::clay, "clay", "Clay", "shape alone: all points in one light grey"},
};

// Kelvin.
constexpr double kBulb = 3600, kGallery = 4300, kNoonSun = 5800;

constexpr double kLampRadius = .25;  ///< m
constexpr double kDuskBegins = 12;   ///< degrees: below this elevation of the sun the backdrop turns to dusk

gi::Backdrop gradient(const glm::dvec3& top, const glm::dvec3& bottom) {
    return {gi::Backdrop::Kind::gradient, top, bottom};
}
const gi::Backdrop kSoftGrey = gradient(glm::dvec3(.62, .65, .69), glm::dvec3(.34, .35, .37));
const gi::Backdrop kSky = gradient(glm::dvec3(.38, .53, .72), glm::dvec3(.78, .82, .86));
const gi::Backdrop kDusk = gradient(glm::dvec3(.10, .12, .20), glm::dvec3(.42, .31, .28));
const gi::Backdrop kDark = gradient(glm::dvec3(.10, .10, .11), glm::dvec3(.03, .03, .035));

/// A sky of one colour, which does not cover the backdrop.
std::shared_ptr<const gi::Environment> sky_of(const glm::dvec3& radiance) {
    auto sky = std::make_shared<gi::Environment>();
    sky->texels = {glm::vec3(radiance)};
    sky->scale = radiance;
    return sky;
}

/// A sky of the daylight model, whose picture update_daylight() makes.
std::shared_ptr<const gi::Environment> clear_sky() {
    auto sky = std::make_shared<gi::Environment>();
    sky->sky.emplace();
    return sky;
}

/// A colour whose luminance is 1.
glm::dvec3 white_of(double kelvin) {
    const glm::dvec3 colour = gi::black_body_colour(kelvin);
    return colour / gi::luminance(colour);
}

glm::dvec3 middle_of(const Site& site) {
    return (site.box[0] + site.box[1]) / 2.0;
}

/// Returns a horizontal direction `degrees` to the left of the camera's view, seen from the middle of the
/// site, raised by `elevation` degrees.
glm::dvec3 left_of_view(const gi::SceneCamera& camera, double degrees, double elevation) {
    const glm::dvec3 back = camera.position - camera.target;
    const double yaw = (back.x == 0 && back.y == 0 ? -std::numbers::pi / 2 : std::atan2(back.y, back.x)) -
                       glm::radians(degrees);
    const double rise = glm::radians(elevation);
    return {std::cos(yaw) * std::cos(rise), std::sin(yaw) * std::cos(rise), std::sin(rise)};
}
/// The north-west, where maps have their light from.
glm::dvec3 north_west(double elevation) {
    const double rise = glm::radians(elevation);
    return {-std::cos(rise) * std::numbers::sqrt2 / 2, std::cos(rise) * std::numbers::sqrt2 / 2,
            std::sin(rise)};
}

gi::SceneLight sun_from(const Site& site, const glm::dvec3& towards, const glm::dvec3& irradiance = {}) {
    gi::SceneLight sun;
    sun.kind = gi::LightKind::directional;
    sun.name = "sun";
    const double away = glm::distance(site.box[0], site.box[1]);
    sun.target = middle_of(site);
    sun.position = sun.target + towards * std::max(away, 1e-3);
    sun.strength = irradiance;
    sun.angular_radius = gi::kSunRadius;
    return sun;
}

/// A spot outside a site that covers all of it, and makes a mid-grey surface in its middle `share` of
/// mid-grey.
gi::SceneLight spot_on(const Site& site, const char* name, const glm::dvec3& towards,
                       const glm::dvec3& colour, double share) {
    const double radius = std::max(glm::distance(site.box[0], site.box[1]) / 2, 1e-3);
    gi::SceneLight spot;
    spot.name = name;
    spot.target = middle_of(site);
    spot.position = spot.target + towards * (2.5 * radius);
    spot.angle = 2 * std::asin(1.1 / 2.5);
    spot.softness = .3;
    const double metres = 2.5 * radius * site.metres_per_unit;
    // A surface of albedo .5 that faces the spot leaves L = (.5 / pi) I / d^2 = .18 share.
    spot.strength = colour * (share * .18 * std::numbers::pi / .5 * metres * metres);
    return spot;
}

/// What is shown as white: half-way between daylight and the light (in mired), because eyes adapt to lamps
/// in part.
glm::dvec3 white_for(double kelvin) {
    const glm::dvec3 white = white_of(2 / (1 / kelvin + 1 / gi::kDaylight)) / white_of(gi::kDaylight);
    return white / gi::luminance(white);
}

/// The light that a room of this size needs, lm: about 100 lx on the ground covered by the box.
double lumens_for(const Site& site) {
    const glm::dvec3 sides = (site.box[1] - site.box[0]) * site.metres_per_unit;
    return std::clamp(100 * sides.x * sides.y, 500.0, 1e6);
}

/// The lamps of a room: lights of one kind at the free places, which share the light that the room needs.
std::vector<gi::SceneLight> lamps_in(const Site& site, gi::LightKind kind, double kelvin) {
    std::vector<gi::SceneLight> lamps;
    const double metre = 1 / site.metres_per_unit;
    for (const glm::dvec3& place : site.inside->lamps) {
        gi::SceneLight& lamp = lamps.emplace_back();
        lamp.kind = kind;
        lamp.name = fmt::format("lamp {}", lamps.size());
        lamp.position = place;
        lamp.target = place - glm::dvec3(0, 0, metre);
        lamp.angle = glm::radians(130.0);
        lamp.softness = .6;
        lamp.radius = kLampRadius * metre;
        lamp.strength = white_of(kelvin);
        gi::set_luminous_flux(lamp, lumens_for(site) / static_cast<double>(site.inside->lamps.size()),
                              site.metres_per_unit);
    }
    return lamps;
}

struct Light {
    std::vector<gi::SceneLight> lights;
    glm::dvec3 sky{0.0};
    gi::Backdrop backdrop;
    double kelvin = gi::kDaylight;  ///< colour temperature of the main light
    bool daylight = false;          ///< the sky is that of the daylight model
};

/// Sun and sky of the daylight model. Shown as films for daylight show them: white at noon, warm in the
/// evening.
Light under_clear_sky(gi::SceneLight sun, const gi::Backdrop& backdrop) {
    sun.daylight = true;
    return {{std::move(sun)}, {}, backdrop, gi::kDaylight, true};
}

bool in_rooms(const Site& site) {
    return site.kind == SiteKind::interior && site.inside;
}

Light daylight(const Site& site, const gi::SceneCamera& camera) {
    glm::dvec3 towards = left_of_view(camera, 50, 42);
    if (site.kind == SiteKind::terrain) towards = north_west(40);
    if (in_rooms(site)) {  // through its windows, or where none was found, from its side
        const glm::dvec3 ahead = site.inside->ahead;
        towards = site.inside->sunward.value_or(normalize(glm::dvec3(-ahead.y, ahead.x, .7) - .4 * ahead));
    }
    return under_clear_sky(sun_from(site, towards), kSky);
}

Light evening(const Site& site, const gi::SceneCamera& camera) {
    if (in_rooms(site)) return {lamps_in(site, gi::LightKind::disc, kBulb), {}, kDark, kBulb};
    return under_clear_sky(sun_from(site, left_of_view(camera, 65, 9)), kDusk);
}

Light raking(const Site& site, const gi::SceneCamera& camera) {
    if (in_rooms(site)) {
        gi::SceneLight lamp;
        lamp.name = "lamp";
        lamp.position = site.inside->left_wall.from;
        lamp.target = site.inside->left_wall.to;
        lamp.angle = glm::radians(110.0);
        lamp.softness = 1;
        lamp.strength = white_of(kGallery);
        gi::set_luminous_flux(lamp, lumens_for(site), site.metres_per_unit);
        return {{lamp}, {}, kDark, kGallery};
    }
    const glm::dvec3 towards = site.kind == SiteKind::terrain ? north_west(12) : left_of_view(camera, 80, 10);
    return {{sun_from(site, towards, white_of(kNoonSun) * 850.0)}, glm::dvec3(6), kDark};
}

Light museum(const Site& site, const gi::SceneCamera& camera) {
    if (in_rooms(site)) return {lamps_in(site, gi::LightKind::spot, kGallery), {}, kDark, kGallery};
    return {{spot_on(site, "key", left_of_view(camera, 45, 45), white_of(kGallery), 1),
             spot_on(site, "fill", left_of_view(camera, -60, 25), white_of(kNoonSun), .2),
             spot_on(site, "rim", left_of_view(camera, 170, 50), white_of(kNoonSun), .6)},
            glm::dvec3(.004),
            kDark,
            kGallery};
}

/// Soft light from everywhere with a key light from the upper left.
Light studio(const Site& site, const gi::SceneCamera& camera) {
    if (in_rooms(site)) return {lamps_in(site, gi::LightKind::disc, gi::kDaylight), {}, kSoftGrey};
    return {{spot_on(site, "key", left_of_view(camera, 40, 50), white_of(gi::kDaylight), 1)},
            glm::dvec3(.12),
            kSoftGrey};
}

}  // namespace

std::span<const MoodInfo> moods() {
    return kMoods;
}

Result<Mood> find_mood(std::string_view name) {
    std::vector<std::string_view> names;
    for (const MoodInfo& info : kMoods) {
        if (info.name == name) return info.mood;
        names.push_back(info.name);
    }
    return bad_arguments("--mood", fmt::format("unknown mood '{}'", name), advice(name, names));
}

std::string_view mood_name(Mood mood) {
    return std::ranges::find(kMoods, mood, &MoodInfo::mood)->name;
}

Mood usual_mood(const Site& site) {
    return in_rooms(site) ? Mood::evening : Mood::daylight;
}

std::string_view prepared_engine() {
    return "paths";
}

std::string_view engine_of(Mood mood, SiteKind kind, bool is_prepared) {
    if (mood == Mood::scan_colours) return gi::engine_with(&gi::EngineInfo::unlit).name;
    const bool outside = kind != SiteKind::interior;
    if (is_prepared && !outside) return prepared_engine();
    const bool under_sky =
        mood == Mood::daylight || (outside && (mood == Mood::evening || mood == Mood::raking_light));
    if (under_sky) {
        // Lights of `vpl` that stand for the sky are pictures of windows on the walls of a room.
        const auto environment = gi::find_engine("environment");
        if (environment && gi::can_run((*environment)->info)) return (*environment)->info.name;
    }
    return gi::default_engine().name;
}

bool shows_moods(std::string_view engine, SiteKind kind, bool is_prepared) {
    return std::ranges::any_of(kMoods, [&](const MoodInfo& info) {
        return engine_of(info.mood, SiteKind::interior) == engine ||
               engine_of(info.mood, kind, is_prepared) == engine;
    });
}

void set_mood(gi::Scene& scene, Mood mood, const Site& site, const gi::SceneCamera& camera) {
    Light light;
    const bool painted = mood != Mood::clay && mood != Mood::scan_colours;
    scene.albedo.white = painted ? site.cast : glm::dvec3(1);
    if (mood == Mood::clay)
        scene.look.colour = gi::ColourBy::clay;
    else if (scene.look.colour == gi::ColourBy::clay)
        scene.look.colour = gi::ColourBy::colour;
    switch (mood) {
        case Mood::scan_colours:  // lights stay for the engines that use them
            scene.look.unlit.shading = site.coloured ? gi::Shading::occlusion : gi::Shading::relief;
            scene.look.unlit.brightness = site.brightness;
            scene.look.backdrop = kSoftGrey;
            return;
        case Mood::daylight:
            light = daylight(site, camera);
            break;
        case Mood::evening:
            light = evening(site, camera);
            break;
        case Mood::raking_light:
            light = raking(site, camera);
            break;
        case Mood::museum:
            light = museum(site, camera);
            break;
        case Mood::clay:
            light = studio(site, camera);
            break;
    }
    scene.lights = std::move(light.lights);
    const bool clear = scene.environment && scene.environment->sky;
    if (!light.daylight)
        scene.environment = light.sky == glm::dvec3(0.0) ? nullptr : sky_of(light.sky);
    else if (!clear)  // else the haze stays that the user has chosen
        scene.environment = clear_sky();
    gi::update_daylight(scene);
    scene.environment_on = true;
    scene.look.backdrop = light.backdrop;
    scene.exposure_ev.reset();
    scene.white = white_for(light.kelvin);
}

void set_daytime(gi::Scene& scene, const gi::SunMoment& moment) {
    const auto sun = std::ranges::find(scene.lights, gi::LightKind::directional, &gi::SceneLight::kind);
    if (sun == scene.lights.end()) return;
    sun->sun = moment;
    sun->daylight = true;
    gi::follow_sun(*sun);
    if (!scene.environment || !scene.environment->sky) scene.environment = clear_sky();
    gi::update_daylight(scene);
    const double elevation = gi::solar_position(moment).elevation;
    const double dusk = std::clamp(1 - elevation / kDuskBegins, 0.0, 1.0);
    const double night = std::clamp(-elevation / 12, 0.0, 1.0);
    const auto between = [](const gi::Backdrop& a, const gi::Backdrop& b, double t) {
        return gradient(glm::mix(a.top, b.top, t), glm::mix(a.bottom, b.bottom, t));
    };
    scene.look.backdrop = between(between(kSky, kDusk, dusk), kDark, night);
}

}  // namespace lucarne::viewer
