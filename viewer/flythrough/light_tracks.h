#pragma once

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
    /// Lights a scene, for which check() holds, as it is at a time of the flight. The sun goes as by
    /// set_daytime(). A lamp whose position meets its target keeps its direction.
    void light(gi::Scene& scene, double time) const;
};

/// Reads the keys "lights" and "sun" of a flythrough. Times: `seconds`.
Result<LightTracks> read_light_tracks(JsonObject& flythrough, JsonRange seconds);
/// Adds these keys to a flythrough, so that they are read back the same.
void write_light_tracks(const LightTracks& tracks, nlohmann::ordered_json& flythrough);

}  // namespace lucarne::viewer
