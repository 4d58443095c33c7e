#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/core/error.h"

namespace lucarne::gi {

/// The scene file, as data/README.md documents it: world coordinates in the scan's own unit, angles in radians.
struct SceneSpot {
    std::string name;
    glm::dvec3 position{0.0}, target{0.0, 0.0, -1.0};
    double angle = 1.0;      ///< full cone
    double softness = 0.1;   ///< share of the half angle over which the edge fades, 0..1
    glm::dvec3 intensity{1.0};  ///< W/sr
};

struct SceneMaterial {
    std::string name;
    glm::dvec3 diffuse{1.0};  ///< scale of the scan's colour
    double specular = 0, shininess = 1;
    glm::dvec3 emission{0.0};
    // Which points it is for; all given conditions must hold. A material with none is the default (index 0).
    std::optional<int> classification;
    std::optional<int> scan;
    std::optional<std::pair<glm::dvec3, glm::dvec3>> box;
};

struct SceneCamera {
    std::string name;
    glm::dvec3 position{0.0}, target{0.0, 1.0, 0.0}, up{0.0, 0.0, 1.0};
    double vertical_fov = 1.0;
};

enum class ToneMap { filmic, reinhard, none };

struct Scene {
    std::vector<SceneSpot> lights;
    std::vector<SceneMaterial> materials;  ///< never empty once loaded: [0] is the default
    std::vector<SceneCamera> cameras;
    std::optional<double> exposure_ev;  ///< stops; radiance is multiplied by 2^ev. Empty: automatic
    ToneMap tone_map = ToneMap::filmic;
    glm::dvec3 background{0.0};         ///< radiance where no surfel is; seen by the camera only
};

/// Errors name the file and the place: the line for syntax, the JSON pointer for a wrong or unknown key.
Result<Scene> load_scene(const std::filesystem::path& path);
Result<Scene> parse_scene(std::string_view text, const std::string& name);

/// What is used without a scene file: a camera that sees the whole box (world units) and one spot beside it, bright
/// enough for a mid-grey picture at exposure 0, which is fixed.
Scene default_scene(const glm::dvec3& min, const glm::dvec3& max, double metres_per_unit = 1.0);

}  // namespace lucarne::gi
