#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "gi/scene/environment.h"
#include "gi/scene/look.h"
#include "gi/scene/render_settings.h"
#include "gi/scene/sun.h"
#include "io/core/error.h"

namespace lucarne::gi {

/// In the order of the kinds of gi/shared/light.h.
enum class LightKind : uint32_t { spot, point, directional, rectangle, disc };

/// The scene file, as data/README.md documents it: world coordinates and lengths in the scan's own unit,
/// angles in radians. What a light's kind does not use keeps its default.
struct SceneLight {
    LightKind kind = LightKind::spot;
    std::string name;
    glm::dvec3 position{0.0},
        target{0.0, 0.0, -1.0};    ///< directional: only the direction between them counts
    glm::dvec3 strength{1.0};      ///< spot, point: W/sr; directional: W/m^2; rectangle, disc: W/(sr m^2)
    double angle = 1.0;            ///< spot: full cone
    double softness = 0.1;         ///< spot: share of the half angle over which the edge fades, 0..1
    double angular_radius = 0;     ///< directional: of the cap of sky it comes from
    double width = 1, height = 1;  ///< rectangle; its height runs along `up` as far as its plane lets it
    glm::dvec3 up{0.0, 0.0, 1.0};
    double radius = 1;  ///< disc
    bool on = true;
    std::optional<SunMoment> sun;  ///< directional: what position and target were computed from

    bool operator==(const SceneLight&) const = default;
};

/// Whether it gives light: it is switched on, and the sun, if it is one, has risen.
bool shines(const SceneLight& light);

struct SceneMaterial {
    std::string name;
    glm::dvec3 diffuse{1.0};  ///< scale of the scan's colour
    double specular = 0, shininess = 1;
    glm::dvec3 emission{0.0};
    bool emits = true;  ///< else the emission is switched off
    // Which points it is for; all given conditions must hold. A material with none is the default (index 0).
    std::optional<int> classification;
    std::optional<int> scan;
    std::optional<std::pair<glm::dvec3, glm::dvec3>> box;

    bool operator==(const SceneMaterial&) const = default;
};

/// What is done to the colours of the points before they count as albedo.
struct Albedo {
    double scale = 1;    ///< 0 to 10; the albedo stays within 0 to .95
    double flatten = 0;  ///< 0 to 1: share of the light that the colours were taken in to be divided out

    bool operator==(const Albedo&) const = default;
};

struct SceneCamera {
    std::string name;
    glm::dvec3 position{0.0}, target{0.0, 1.0, 0.0}, up{0.0, 0.0, 1.0};
    double vertical_fov = 1.0;
    double orthographic_height = 0;  ///< world units that the picture is high; 0: perspective

    bool operator==(const SceneCamera&) const = default;
};

enum class ToneMap { filmic, reinhard, none, false_colour };

/// Two engines in one picture.
struct Comparison {
    enum class Show : uint8_t { split, signed_difference, absolute_difference };
    Show show = Show::split;
    std::string engine;   ///< the other one; empty: the reference
    double border = 0.5;  ///< share of the width that is left of it: the picture's own engine
    double range = 1;     ///< differences of the exposed luminance that have the last colours

    bool operator==(const Comparison&) const = default;
};
/// As files and options call them, in the order of the enumerators.
std::span<const std::string_view> comparison_names();
std::span<const std::string_view> tone_map_names();

struct Scene {
    std::vector<SceneLight> lights;
    std::vector<SceneMaterial> materials;  ///< never empty once loaded: [0] is the default
    std::vector<SceneCamera> cameras;
    std::optional<double> exposure_ev;  ///< stops; radiance is multiplied by 2^ev. Empty: automatic
    ToneMap tone_map = ToneMap::filmic;
    std::optional<ValueRange> luminance;  ///< cd/m^2, of false colours; empty: about the exposure's middle
    glm::dvec3 background{0.0};           ///< radiance where no surfel is; seen by the camera only
    std::shared_ptr<const Environment>
        environment;  ///< lights, and is seen in the place of `background`; or none
    bool environment_on = true;
    Albedo albedo;
    Look look;  ///< of the points, whatever lights them
    std::optional<Comparison> comparison;
    RenderSettings render;  ///< what the file says of it; the command line wins
};

/// Errors name the file and the place: the line for syntax, the JSON pointer for a wrong or unknown key.
Result<Scene> load_scene(const std::filesystem::path& path);
/// Pictures are looked for in the scene file's folder, by parse_scene in `folder`.
Result<Scene> parse_scene(std::string_view text, const std::string& name,
                          const std::filesystem::path& folder = ".");

/// A text that parse_scene() in `folder` reads to the same scene: pictures are named as seen from there.
std::string write_scene(const Scene& scene, const std::filesystem::path& folder = ".");
/// Errors: the file cannot be written.
Result<void> save_scene(const Scene& scene, const std::filesystem::path& path, bool overwrite);

/// What is used without a scene file: a camera to whose picture (width over height: `aspect`) the whole box
/// (world units) just fits, and one spot beside it, bright enough for a mid-grey picture at exposure 0, which
/// is fixed.
Scene default_scene(const glm::dvec3& min, const glm::dvec3& max, double metres_per_unit = 1.0,
                    double aspect = 4.0 / 3);

}  // namespace lucarne::gi
