#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gi/scene/scene.h"
#include "io/files/json.h"
#include "viewer/flythrough/curve.h"

namespace lucarne::viewer {

/// What one light of the scene does during a flight. A quantity without keys stays as the scene has it.
struct LightTrack {
    std::string name;
    std::vector<Timed<glm::dvec3>> position, target;  ///< world coordinates; curves
    std::vector<Timed<glm::dvec3>> strength;          ///< as gi::SceneLight::strength; a curve, never below 0
    std::vector<Timed<bool>> on;                      ///< each until the next
    bool operator==(const LightTrack&) const = default;
};

/// What the lights do during a flight; data/README.md ("Flythroughs") documents it.
struct LightTracks {
    std::vector<LightTrack> lights;
    std::vector<Timed<gi::Moment>> sun;  ///< the time of day runs evenly from each key to the next
    bool empty() const { return lights.empty() && sun.empty(); }
    bool operator==(const LightTracks&) const = default;

    /// Errors: the scene has no light of a track's name, or several; a directional light would have to move;
    /// there is no sun whose time could run.
    Result<void> check(const gi::Scene& scene) const;
    /// Lights `scene`, which differs from `base` by what tracks have changed before alone, as it is at a time
    /// of the flight, whatever the time before was; check() must hold for it. The sun goes as by
    /// set_daytime(), which costs a picture of the sky if its second is another one. A lamp whose position
    /// meets its target has the direction of `base`.
    void apply(const gi::Scene& base, double time, gi::Scene& scene) const;
};

/// Reads the time of a key, which must be kLeastStep later than that of the key before, if there is one.
Result<double> read_key_time(JsonObject& key, std::optional<double> before);
/// Reads the keys "lights" and "sun" of a flythrough.
Result<LightTracks> read_light_tracks(JsonObject& flythrough);
/// Adds these keys to a flythrough, so that they are read back the same.
void write_light_tracks(const LightTracks& tracks, nlohmann::ordered_json& flythrough);

}  // namespace lucarne::viewer
