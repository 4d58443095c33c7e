#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "gi/scene/look_file.h"
#include "gi/scene/render_settings_file.h"
#include "gi/scene/scene.h"
#include "gi/scene/scene_lights.h"
#include "gi/scene/scene_limits.h"
#include "gi/scene/sky_model.h"
#include "io/files/json.h"

namespace lucarne::gi {
namespace {

using glm::dvec3;

// data/README.md states these limits.
constexpr size_t kMostMaterials = 255, kMostCameras = 1000;
constexpr JsonRange kScale{0, 10}, kFovDegrees{1, 170}, kStops{-40, 40}, kShininess{0, 1e6},
    kLuminance{1e-9, 1e15}, kWhite{1e-3, 1e3}, kDifference{1e-6, 1e6};

std::vector<std::string_view> list(std::span<const std::string_view> names) {
    return {names.begin(), names.end()};
}

/// Reads the box of this key; empty: there is none.
Result<std::optional<SceneBox>> read_box(JsonObject& object, std::string_view key) {
    LUCARNE_ASSIGN(auto box, object.object(key));
    if (!box) return std::optional<SceneBox>();
    LUCARNE_ASSIGN(const dvec3 min, box->vector("min", kCoordinate));
    LUCARNE_ASSIGN(const dvec3 max, box->vector("max", kCoordinate));
    if (min.x > max.x || min.y > max.y || min.z > max.z) return box->wrong("lies below min", "max");
    LUCARNE_TRY(box->finish());
    return std::optional<SceneBox>({min, max});
}

Result<SceneMaterial> read_material(JsonObject object) {
    SceneMaterial material;
    LUCARNE_ASSIGN(material.name, object.text("name", ""));
    LUCARNE_ASSIGN(material.diffuse, object.vector("diffuse", kScale, dvec3(1)));
    LUCARNE_ASSIGN(material.specular, object.number("specular", kShare, 0));
    LUCARNE_ASSIGN(material.shininess, object.number("shininess", kShininess, 1));
    LUCARNE_ASSIGN(material.emission, object.vector("emission", kRadiance, dvec3(0)));
    LUCARNE_ASSIGN(material.emits, object.boolean("on", true));
    LUCARNE_ASSIGN(const int64_t classification, object.integer("class", 0, 255, -1));
    if (classification >= 0) material.classification = static_cast<int>(classification);
    LUCARNE_ASSIGN(const int64_t scan, object.integer("scan", 0, 65535, -1));
    if (scan >= 0) material.scan = static_cast<int>(scan);
    LUCARNE_ASSIGN(material.box, read_box(object, "box"));
    LUCARNE_TRY(object.finish());
    return material;
}

Result<SceneCamera> read_camera(JsonObject object) {
    SceneCamera camera;
    LUCARNE_ASSIGN(camera.name, object.text("name"));
    LUCARNE_ASSIGN(camera.position, object.vector("position", kCoordinate));
    LUCARNE_ASSIGN(camera.target, object.vector("target", kCoordinate));
    LUCARNE_ASSIGN(camera.up, object.vector("up", kCoordinate, dvec3(0, 0, 1)));
    LUCARNE_ASSIGN(camera.vertical_fov, object.number("fov", kFovDegrees, 60));
    camera.vertical_fov = glm::radians(camera.vertical_fov);
    LUCARNE_ASSIGN(camera.orthographic_height, object.number("orthographic_height", {0, 1e9}, 0.0));
    const dvec3 forward = camera.target - camera.position;
    if (forward == dvec3(0)) return object.wrong("is where the camera stands", "target");
    // Six millionths of a degree: closer to the up direction the camera's roll is noise.
    if (glm::length(cross(forward, camera.up)) <= 1e-7 * glm::length(forward) * glm::length(camera.up))
        return object.wrong("the camera looks along its up direction", object.has("up") ? "up" : "target");
    LUCARNE_TRY(object.finish());
    return camera;
}

bool applies_everywhere(const SceneMaterial& material) {
    return !material.classification && !material.scan && !material.box;
}

Result<void> read_materials(JsonObject& root, Scene& scene) {
    LUCARNE_ASSIGN(const auto objects, root.objects("materials", kMostMaterials));
    scene.materials = {SceneMaterial{}};
    scene.materials[0].name = "default";
    bool has_default = false;
    for (const JsonObject& object : objects) {
        LUCARNE_ASSIGN(SceneMaterial material, read_material(object));
        if (!applies_everywhere(material)) {
            scene.materials.push_back(std::move(material));
            continue;
        }
        if (has_default) return object.wrong("a second material without class, scan or box");
        has_default = true;
        scene.materials[0] = std::move(material);
    }
    return {};
}

Result<void> read_exposure(JsonObject& root, Scene& scene) {
    LUCARNE_ASSIGN(auto exposure, root.object("exposure"));
    if (!exposure) return {};
    LUCARNE_ASSIGN(const double ev, exposure->number("ev", kStops, NAN));
    if (!std::isnan(ev)) scene.exposure_ev = ev;
    LUCARNE_ASSIGN(const size_t tone_map, exposure->choice("tone_map", list(tone_map_names()), 0));
    scene.tone_map = static_cast<ToneMap>(tone_map);
    LUCARNE_ASSIGN(scene.white, exposure->vector("white", kWhite, dvec3(1)));
    LUCARNE_ASSIGN(auto ends, exposure->object("luminance"));
    if (ends) {
        ValueRange range;
        LUCARNE_ASSIGN(range.low, ends->number("low", kLuminance));
        LUCARNE_ASSIGN(range.high, ends->number("high", kLuminance));
        if (!(range.low < range.high)) return ends->wrong("is not above low", "high");
        LUCARNE_TRY(ends->finish());
        scene.luminance = range;
    }
    return exposure->finish();
}

Result<Albedo> read_albedo(JsonObject object) {
    Albedo albedo;
    LUCARNE_ASSIGN(albedo.scale, object.number("scale", kScale, 1));
    LUCARNE_ASSIGN(albedo.flatten, object.number("flatten", kShare, 0));
    LUCARNE_ASSIGN(albedo.balance, object.boolean("balance", true));
    LUCARNE_ASSIGN(albedo.white, object.vector("white", kWhite, dvec3(1)));
    LUCARNE_TRY(object.finish());
    return albedo;
}

Result<Comparison> read_comparison(JsonObject object) {
    Comparison comparison;
    LUCARNE_ASSIGN(comparison.engine, object.text("engine", comparison.engine));
    LUCARNE_ASSIGN(const size_t show, object.choice("show", list(comparison_names()), 0));
    comparison.show = static_cast<Comparison::Show>(show);
    LUCARNE_ASSIGN(comparison.border, object.number("border", kShare, comparison.border));
    LUCARNE_ASSIGN(comparison.range, object.number("range", kDifference, comparison.range));
    LUCARNE_TRY(object.finish());
    return comparison;
}

Result<Scene> read_scene(const nlohmann::json& document, const std::string& name,
                         const std::filesystem::path& folder) {
    LUCARNE_ASSIGN(JsonObject root, JsonObject::of(document, name));
    Scene scene;
    LUCARNE_TRY(read_exposure(root, scene));
    LUCARNE_ASSIGN(scene.background, root.vector("background", kRadiance, dvec3(0)));
    LUCARNE_ASSIGN(const auto lights, root.objects("lights", kMostLights));
    for (const JsonObject& object : lights) {
        LUCARNE_ASSIGN(SceneLight light, read_light(object));
        scene.lights.push_back(std::move(light));
    }
    LUCARNE_ASSIGN(const auto environment, root.object("environment"));
    if (environment) {
        if (root.has("background"))
            return root.wrong("the environment is the background; leave this out", "background");
        JsonObject sky = *environment;
        LUCARNE_ASSIGN(scene.environment_on, sky.boolean("on", true));
        LUCARNE_ASSIGN(scene.environment,
                       read_environment(std::move(sky), folder, direction_to_sun(scene.lights)));
    }
    update_daylight(scene);
    LUCARNE_ASSIGN(scene.lighting_region, read_box(root, "lighting_region"));
    LUCARNE_TRY(read_materials(root, scene));
    LUCARNE_ASSIGN(const auto albedo, root.object("albedo"));
    if (albedo) {
        LUCARNE_ASSIGN(scene.albedo, read_albedo(*albedo));
    }
    LUCARNE_ASSIGN(const auto comparison, root.object("comparison"));
    if (comparison) {
        LUCARNE_ASSIGN(scene.comparison, read_comparison(*comparison));
    }
    LUCARNE_ASSIGN(const auto render, root.object("render"));
    if (render) {
        LUCARNE_ASSIGN(scene.render, read_render_settings(*render));
    }
    LUCARNE_ASSIGN(const auto look, root.object("look"));
    if (look) {
        LUCARNE_ASSIGN(scene.look, read_look(*look));
    }
    LUCARNE_ASSIGN(const auto cameras, root.objects("cameras", kMostCameras));
    std::set<std::string> names;
    for (const JsonObject& object : cameras) {
        LUCARNE_ASSIGN(SceneCamera camera, read_camera(object));
        if (!names.insert(camera.name).second)
            return object.wrong(fmt::format("a second camera '{}'", camera.name), "name");
        scene.cameras.push_back(std::move(camera));
    }
    LUCARNE_TRY(root.finish());
    return scene;
}

/// Returns the distance from the centre of a box of these half sizes at which the box fits the picture with
/// a small margin.
double fitting_distance(const dvec3& half, const dvec3& right, const dvec3& up, const dvec3& back, double fov,
                        double aspect) {
    constexpr double kMargin = .94;
    const double tall = kMargin * std::tan(fov / 2), wide = tall * aspect;
    double distance = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const dvec3 c = half * dvec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        const double reach = std::max(std::abs(dot(c, right)) / wide, std::abs(dot(c, up)) / tall);
        distance = std::max(distance, reach + dot(c, back));
    }
    return distance;
}

}  // namespace

std::span<const std::string_view> tone_map_names() {
    static constexpr std::array<std::string_view, 5> kNames = {"filmic", "reinhard", "none", "false-colour",
                                                               "illuminance"};
    return kNames;
}

std::span<const std::string_view> comparison_names() {
    static constexpr std::array<std::string_view, 3> kNames = {"split", "signed", "absolute"};
    return kNames;
}

Result<Scene> parse_scene(std::string_view text, const std::string& name,
                          const std::filesystem::path& folder) {
    LUCARNE_ASSIGN(const nlohmann::json document, parse_json(text, name));
    return read_scene(document, name, folder);
}

Result<Scene> load_scene(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(const nlohmann::json document, load_json(path));
    return read_scene(document, path.string(), path.parent_path());
}

Scene default_scene(const dvec3& min, const dvec3& max, double metres_per_unit, double aspect) {
    dvec3 centre = (min + max) / 2.0;
    double radius = glm::length(max - min) / 2;
    if (!std::isfinite(radius)) centre = dvec3(0), radius = 1;  // an empty box: nothing to frame
    radius = std::max(radius, 1e-3);

    constexpr double kFov = glm::radians(50.0);
    SceneCamera camera;
    camera.name = "overview";
    camera.vertical_fov = kFov;
    camera.target = centre;
    const dvec3 back = glm::normalize(dvec3(-.55, -1, .6));
    const dvec3 right = glm::normalize(cross(-back, camera.up)), up = cross(right, -back);
    const double fitting = fitting_distance((max - min) / 2.0, right, up, back, kFov, aspect);
    camera.position = centre + back * std::clamp(fitting, 1e-3, 2 * radius / std::sin(kFov / 2));

    SceneLight spot;
    spot.name = "beside the camera";
    const double distance = radius / std::sin(kFov / 2);
    spot.position = centre + (back + right * .35 + up * .35) * distance;
    spot.target = centre;
    const double from = glm::length(spot.position - centre);
    spot.angle = 2 * std::asin(std::min(.95, 1.1 * radius / from));
    // A surface of albedo .5 in the middle, lit at 45 degrees, leaves L = (.5 / pi) I cos(45) / d^2 = .18.
    const double metres = from * metres_per_unit;
    spot.strength = dvec3(.18 * M_PI / .5 * metres * metres / M_SQRT1_2);

    Scene scene;
    scene.lights = {spot};
    scene.materials = {SceneMaterial{}};
    scene.materials[0].name = "default";
    scene.cameras = {camera};
    scene.exposure_ev = 0;
    return scene;
}

}  // namespace lucarne::gi
