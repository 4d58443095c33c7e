#include "viewer/flythrough/light_tracks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/scene/scene_limits.h"
#include "gi/scene/sky_model.h"
#include "viewer/opening/moods.h"

namespace lucarne::viewer {
namespace {

using glm::dvec3;

constexpr size_t kMostLightKeys = 10000;
constexpr JsonRange kSeconds{0, 1e5};
/// s. Curves through keys that are nearer to each other would be too steep for numbers.
constexpr double kLeastStep = 1e-3;

Result<void> read_vector(JsonObject& object, std::string_view name, double time, JsonRange range,
                         std::vector<Timed<dvec3>>& keys) {
    if (!object.has(name)) return {};
    LUCARNE_ASSIGN(const dvec3 value, object.vector(name, range));
    keys.push_back({time, value});
    return {};
}

/// Returns whether the last key of any quantity is at this time.
bool says_anything(const LightTrack& track, double time) {
    const auto ends = [&](const auto& keys) { return !keys.empty() && keys.back().time == time; };
    return ends(track.position) || ends(track.target) || ends(track.strength) || ends(track.on);
}

Result<LightTrack> read_track(JsonObject& object) {
    LightTrack track;
    LUCARNE_ASSIGN(track.name, object.text("name"));
    if (track.name.empty()) return object.wrong("names no light", "name");
    LUCARNE_ASSIGN(std::vector<JsonObject> keys, object.objects("keys", kMostLightKeys));
    LUCARNE_TRY(object.finish());
    if (keys.empty()) return object.wrong("must hold at least one key", "keys");
    std::optional<double> before;
    for (JsonObject& key : keys) {
        LUCARNE_ASSIGN(const double time, read_key_time(key, before));
        before = time;
        LUCARNE_TRY(read_vector(key, "position", time, gi::kCoordinate, track.position));
        LUCARNE_TRY(read_vector(key, "target", time, gi::kCoordinate, track.target));
        LUCARNE_TRY(read_vector(key, "strength", time, gi::kRadiance, track.strength));
        if (key.has("on")) {
            LUCARNE_ASSIGN(const bool on, key.boolean("on"));
            track.on.push_back({time, on});
        }
        LUCARNE_TRY(key.finish());
        if (!says_anything(track, time)) return key.wrong("says nothing of the light");
    }
    return track;
}

Result<Timed<gi::Moment>> read_clock(JsonObject& key, std::optional<double> before) {
    Timed<gi::Moment> read;
    LUCARNE_ASSIGN(read.time, read_key_time(key, before));
    LUCARNE_ASSIGN(const std::string clock, key.text("clock"));
    LUCARNE_TRY(key.finish());
    const auto moment = gi::parse_time(clock);
    if (!moment) return key.wrong(moment.error().line(), "clock");
    read.value = *moment;
    return read;
}

/// Returns the time of day, to the second, by the clock of the key before.
gi::Moment moment_at(const std::vector<Timed<gi::Moment>>& keys, double time) {
    const size_t i = key_before(keys, time);
    gi::Moment moment = keys[i].value;
    if (time <= keys[i].time || i + 1 == keys.size()) return moment;
    const double share = (time - keys[i].time) / (keys[i + 1].time - keys[i].time);
    moment.seconds += std::llround(share * static_cast<double>(keys[i + 1].value.seconds - moment.seconds));
    return moment;
}

/// A point of a curve, which may leave the range of its keys.
dvec3 within(JsonRange range, const std::vector<Timed<dvec3>>& keys, double time) {
    return glm::clamp(curve_at(keys, time), range.least, range.most);
}

void follow(const LightTrack& track, const gi::SceneLight& base, double time, gi::SceneLight& light) {
    if (!track.on.empty()) light.on = track.on[key_before(track.on, time)].value;
    if (!track.strength.empty()) {
        light.daylight = false;
        light.strength = within(gi::kRadiance, track.strength, time);
    }
    if (track.position.empty() && track.target.empty()) return;
    light.position = track.position.empty() ? base.position : within(gi::kCoordinate, track.position, time);
    light.target = track.target.empty() ? base.target : within(gi::kCoordinate, track.target, time);
    if (light.kind == gi::LightKind::point) light.target = light.position - dvec3(0, 0, 1);
    if (light.target != light.position) return;
    // Of length about 1, so that far from the origin it is not lost by rounding.
    const dvec3 axis = base.target - base.position, size = glm::abs(axis);
    light.target = light.position + axis / std::max({size.x, size.y, size.z});
}

/// Returns a vector as JSON.
nlohmann::ordered_json json_of(const dvec3& v) {
    return {v.x, v.y, v.z};
}

}  // namespace

Result<void> LightTracks::check(const gi::Scene& scene) const {
    for (const LightTrack& track : lights) {
        const std::string what = fmt::format("light '{}' of the flythrough", track.name);
        const auto named = std::ranges::count(scene.lights, track.name, &gi::SceneLight::name);
        if (named != 1)
            return rejected(
                what,
                named ? "the scene has several lights of this name" : "the scene has no light of this name",
                "give each light that moves a name of its own in the scene file");
        const auto light = std::ranges::find(scene.lights, track.name, &gi::SceneLight::name);
        if (light->kind == gi::LightKind::directional && (!track.position.empty() || !track.target.empty()))
            return rejected(what, "is directional: it is nowhere and does not move",
                            "let the time of the sun run, or take a spot");
    }
    if (!sun.empty() && !gi::direction_to_sun(scene.lights))
        return rejected("sun of the flythrough", "the scene has no directional light, so no sun");
    return {};
}

void LightTracks::apply(const gi::Scene& base, double time, gi::Scene& scene) const {
    if (!sun.empty()) {
        const auto light = std::ranges::find(scene.lights, gi::LightKind::directional, &gi::SceneLight::kind);
        gi::SunMoment moment = light->sun.value_or(gi::SunMoment{});
        moment.time = moment_at(sun, time);
        set_daytime(scene, moment);
    }
    for (const LightTrack& track : lights) {
        const auto light = std::ranges::find(scene.lights, track.name, &gi::SceneLight::name);
        follow(track, base.lights[static_cast<size_t>(light - scene.lights.begin())], time, *light);
    }
}

Result<double> read_key_time(JsonObject& key, std::optional<double> before) {
    LUCARNE_ASSIGN(const double time, key.number("time", kSeconds));
    if (before && !(time >= *before + kLeastStep))
        return key.wrong(
            fmt::format("must be later than {} s, the time of the key before, by {} s", *before, kLeastStep),
            "time");
    return time;
}

Result<LightTracks> read_light_tracks(JsonObject& flythrough) {
    LightTracks tracks;
    LUCARNE_ASSIGN(std::vector<JsonObject> lights, flythrough.objects("lights", gi::kMostLights));
    std::set<std::string> names;
    for (JsonObject& object : lights) {
        LUCARNE_ASSIGN(LightTrack track, read_track(object));
        if (!names.insert(track.name).second)
            return object.wrong("has keys already: a light has one list of them", "name");
        tracks.lights.push_back(std::move(track));
    }
    LUCARNE_ASSIGN(std::vector<JsonObject> clock, flythrough.objects("sun", kMostLightKeys));
    for (JsonObject& object : clock) {
        std::optional<double> before;
        if (!tracks.sun.empty()) before = tracks.sun.back().time;
        LUCARNE_ASSIGN(const Timed<gi::Moment> key, read_clock(object, before));
        tracks.sun.push_back(key);
    }
    return tracks;
}

void write_light_tracks(const LightTracks& tracks, nlohmann::ordered_json& flythrough) {
    using Json = nlohmann::ordered_json;
    for (const LightTrack& track : tracks.lights) {
        std::map<double, Json> keys;
        for (const auto& key : track.position) keys[key.time]["position"] = json_of(key.value);
        for (const auto& key : track.target) keys[key.time]["target"] = json_of(key.value);
        for (const auto& key : track.strength) keys[key.time]["strength"] = json_of(key.value);
        for (const auto& key : track.on) keys[key.time]["on"] = key.value;
        Json list = Json::array();
        for (const auto& [time, values] : keys) {
            Json key{{"time", time}};
            key.update(values);
            list.push_back(std::move(key));
        }
        flythrough["lights"].push_back({{"name", track.name}, {"keys", std::move(list)}});
    }
    for (const auto& key : tracks.sun)
        flythrough["sun"].push_back({{"time", key.time}, {"clock", gi::time_text(key.value)}});
}

}  // namespace lucarne::viewer
