#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/scene/environment.h"
#include "gi/scene/look.h"
#include "gi/scene/render_settings.h"
#include "gi/scene/sun.h"
#include "io/core/error.h"

namespace lucarne::gi {

/// Kinds of lights, in the order of gi/shared/light.h.
enum class LightKind : uint32_t { spot, point, directional, rectangle, disc };

/// A light of a scene file (data/README.md): world coordinates and lengths in the scan's own unit, angles in
/// radians. Fields that a kind does not use keep their defaults.
struct SceneLight {
    LightKind kind = LightKind::spot;
    std::string name;
    glm::dvec3 position{0.0},
        target{0.0, 0.0, -1.0};    ///< directional: only the direction from position to target counts
    glm::dvec3 strength{1.0};      ///< spot, point: W/sr; directional: W/m^2; rectangle, disc: W/(sr m^2)
    double angle = 1.0;            ///< spot: full cone
    double softness = 0.1;         ///< spot: share of the half angle over which the edge fades, 0 to 1
    double angular_radius = 0;     ///< directional: of the cap of sky that it comes from
    double width = 1, height = 1;  ///< rectangle; the height runs along `up`, projected into its plane
    glm::dvec3 up{0.0, 0.0, 1.0};
    double radius = 1;  ///< disc
    bool on = true;
    std::optional<SunMoment> sun;  ///< directional: what position and target were computed from
    bool daylight = false;         ///< directional: the strength is the sun's, by gi/scene/sky_model.h

    bool operator==(const SceneLight&) const = default;
};

/// Returns whether the light is switched on and, if it is a sun, above the horizon.
bool shines(const SceneLight& light);

/// The corners of a box with the least and with the largest coordinates, world units.
using SceneBox = std::pair<glm::dvec3, glm::dvec3>;

struct SceneMaterial {
    std::string name;
    glm::dvec3 diffuse{1.0};  ///< scale of the scan's colour
    double specular = 0, shininess = 1;
    glm::dvec3 emission{0.0};
    bool emits = true;  ///< false: the emission is switched off
    // Which points the material applies to; all given conditions must hold. A material without conditions is
    // the default (index 0).
    std::optional<int> classification;
    std::optional<int> scan;
    std::optional<SceneBox> box;

    bool operator==(const SceneMaterial&) const = default;
    /// What decides which points have this material, for comparisons.
    auto assignment() const { return std::tie(classification, scan, box); }
};

/// How the colours of the points become their albedo.
struct Albedo {
    double scale = 1;    ///< 0 to 10; the albedo stays within 0 to .95
    double flatten = 0;  ///< 0 to 1: how much of the light at the time of the scan is divided out
    /// Whether stations of different exposure are balanced, and points that were never photographed get the
    /// colour of those around them.
    bool balance = true;
    /// The linear colour of a white surface in the scan: the colour of the light at that time, which is
    /// divided out. Its brightness does not matter.
    glm::dvec3 white{1.0};

    bool operator==(const Albedo&) const = default;
    /// What is packed into surfels, for comparisons.
    auto packed() const { return std::tie(flatten, balance, white); }
};

struct SceneCamera {
    std::string name;
    glm::dvec3 position{0.0}, target{0.0, 1.0, 0.0}, up{0.0, 0.0, 1.0};
    double vertical_fov = 1.0;
    double orthographic_height = 0;  ///< height of the view, world units; 0: perspective

    bool operator==(const SceneCamera&) const = default;
};

/// The last two are no curves: they show figures by colours, of what leaves surfaces and of what reaches
/// them.
enum class ToneMap { filmic, reinhard, none, false_colour, illuminance };
inline bool shows_figures(ToneMap shown) {
    return shown >= ToneMap::false_colour;
}

/// Two engines in one picture.
struct Comparison {
    enum class Show : uint8_t { split, signed_difference, absolute_difference };
    Show show = Show::split;
    std::string engine;   ///< the second engine; empty: the reference
    double border = 0.5;  ///< share of the width left of the border, which the picture's own engine fills
    double range = 1;     ///< difference of exposed luminance that gets the last colour of the map

    bool operator==(const Comparison&) const = default;
};
/// Their names in files and options, in the order of the enumerators.
std::span<const std::string_view> comparison_names();
std::span<const std::string_view> tone_map_names();

struct Scene {
    std::vector<SceneLight> lights;
    std::vector<SceneMaterial> materials;  ///< never empty once loaded; [0] is the default
    std::vector<SceneCamera> cameras;
    std::optional<double> exposure_ev;  ///< stops; radiance is multiplied by 2^ev. Empty: automatic
    ToneMap tone_map = ToneMap::filmic;
    glm::dvec3 white{1.0};                ///< radiance of this colour (linear) is shown as neutral
    std::optional<ValueRange> luminance;  ///< cd/m^2, range of false colours; empty: around mid-grey
    glm::dvec3 background{0.0};           ///< radiance where no surfel is; only the camera sees it
    std::shared_ptr<const Environment>
        environment;  ///< lights the scene and replaces `background`; may be null
    bool environment_on = true;
    std::optional<SceneBox> lighting_region;  ///< where lamps will be; empty: anywhere
    Albedo albedo;
    Look look;  ///< how points are shown, whichever engine lights them
    std::optional<Comparison> comparison;
    RenderSettings render;  ///< as the file states it; the command line overrides it

    /// All that the light of a picture depends on, for comparisons: not how it is shown (exposure, tone
    /// curve, a comparison's border), nor the cameras.
    auto light_inputs() const {
        return std::tuple_cat(std::tie(lights, materials, background, environment, environment_on,
                                       lighting_region, albedo, look),
                              std::make_tuple(comparison ? comparison->engine : std::string()));
    }
};

/// Reads a scene file. Errors name the file and the place: the line for syntax, the JSON pointer for a wrong
/// or unknown key.
Result<Scene> load_scene(const std::filesystem::path& path);
/// Reads a scene from a text that errors call `name`. Paths of pictures are relative to the scene file's
/// folder, for parse_scene() to `folder`.
Result<Scene> parse_scene(std::string_view text, const std::string& name,
                          const std::filesystem::path& folder = ".");

/// Returns a text that parse_scene() with the same `folder` reads to an equal scene. Paths of pictures are
/// written relative to `folder`.
std::string write_scene(const Scene& scene, const std::filesystem::path& folder = ".");
/// Writes a scene file. Errors: the file cannot be written.
Result<void> save_scene(const Scene& scene, const std::filesystem::path& path, bool overwrite);

/// Returns the simplest scene for a box, of which scene files without cameras take the camera, and which
/// `viewer/opening` replaces where nothing else is asked for: a camera in whose picture (width over height:
/// `aspect`) the whole box (world units) just fits, and one spot beside it. The spot is bright enough for a
/// mid-grey picture at exposure 0, and the exposure is fixed at that.
Scene default_scene(const glm::dvec3& min, const glm::dvec3& max, double metres_per_unit = 1.0,
                    double aspect = 4.0 / 3);

}  // namespace lucarne::gi
