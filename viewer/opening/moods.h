#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "gi/scene/scene.h"
#include "viewer/opening/site.h"

namespace lucarne::viewer {

/// Light of one kind for any site.
enum class Mood : uint8_t {
    scan_colours,  ///< the points' own colours with ambient occlusion
    daylight,      ///< sun and sky
    evening,       ///< warm lamps in rooms; a low sun outside
    raking_light,  ///< grazing light from the left, which shows relief
    museum,        ///< spots from above before a dark background
    clay           ///< all points of one light grey, in soft light
};
struct MoodInfo {
    Mood mood;
    std::string_view name;   ///< on the command line
    std::string_view label;  ///< in the window
    std::string_view help;
};
std::span<const MoodInfo> moods();
/// Errors (ErrorKind::arguments): there is no mood of that name.
Result<Mood> find_mood(std::string_view name);

std::string_view mood_name(Mood mood);

/// Returns the light that a site is first shown in.
Mood usual_mood(const Site& site);
/// Returns the engine that shows a mood: `unlit` for scan colours; in rooms whose light paths are known
/// (`is_prepared`) `paths`, which is nearest to `reference` there by day and by lamps; `environment` where a
/// sky lights the site (by day, and outside also in the evening and for raking light) if this machine can run
/// it; else the default engine.
std::string_view engine_of(Mood mood, SiteKind kind, bool is_prepared = false);
/// Whether some mood is shown by this engine: of rooms, or of a prepared site of this kind. Others were
/// chosen by a person, and stay when the mood changes.
bool shows_moods(std::string_view engine, SiteKind kind, bool is_prepared = false);
/// The engine that shows rooms once it has computed its light paths.
std::string_view prepared_engine();

/// Replaces the scene's lights, sky, backdrop and exposure; the points' colours for clay, and from clay.
/// Light comes from the left of `camera`'s view of objects, and by day from the north-west for terrain. All
/// strengths are physical: a mood looks the same whatever the site's size and unit.
void set_mood(gi::Scene& scene, Mood mood, const Site& site, const gi::SceneCamera& camera);

/// Moves the first sun of a scene in `daylight` to where it stands at a place and time, and gives sun, sky
/// and backdrop the light of that hour on a clear day. Does nothing without a sun.
void set_daytime(gi::Scene& scene, const gi::SunMoment& moment);

}  // namespace lucarne::viewer
