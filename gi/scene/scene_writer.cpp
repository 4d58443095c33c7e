// Writes scenes as files that parse_scene() reads. Default values are left out.
#include <array>
#include <cmath>

#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "gi/scene/degrees.h"
#include "gi/scene/look_file.h"
#include "gi/scene/render_settings_file.h"
#include "gi/scene/scene.h"
#include "gi/scene/sky_model.h"
#include "io/files/file.h"
#include "io/files/json.h"

namespace lucarne::gi {
namespace {

using glm::dvec3;
using Json = nlohmann::ordered_json;

Json vector(const dvec3& v) {
    return {v.x, v.y, v.z};
}

void put(Json& object, const char* key, const auto& value, const auto& otherwise) {
    if (value != otherwise) object[key] = value;
}
void put(Json& object, const char* key, const dvec3& value, const dvec3& otherwise) {
    if (value != otherwise) object[key] = vector(value);
}

Json write_sun(const SunMoment& sun) {
    Json written = {{"latitude", sun.latitude}, {"longitude", sun.longitude}, {"time", time_text(sun.time)}};
    put(written, "north", sun.north, 0.0);
    return written;
}

Json write_light(const SceneLight& light) {
    static constexpr std::array kTypes = {"spot", "point", "directional", "rectangle", "disc"};
    static constexpr std::array kStrengths = {"intensity", "intensity", "irradiance", "radiance", "radiance"};
    const SceneLight plain;
    const bool sun = light.kind == LightKind::directional;
    Json written = {{"type", kTypes[static_cast<size_t>(light.kind)]}};
    put(written, "name", light.name, plain.name);
    put(written, "on", light.on, true);
    if (!sun) written["position"] = vector(light.position);
    if (sun && light.sun)
        written["sun"] = write_sun(*light.sun);
    else if (sun)
        written["direction"] = vector(light.target - light.position);
    else if (light.kind != LightKind::point)
        written["target"] = vector(light.target);
    switch (light.kind) {
        case LightKind::spot:
            written["angle"] = degrees_of(light.angle);
            put(written, "softness", light.softness, plain.softness);
            break;
        case LightKind::directional:
            if (light.angular_radius != (light.daylight ? kSunRadius : 0))
                written["angular_radius"] = degrees_of(light.angular_radius);
            break;
        case LightKind::rectangle:
            written["width"] = light.width;
            written["height"] = light.height;
            put(written, "up", light.up, plain.up);
            break;
        case LightKind::disc:
            written["radius"] = light.radius;
            break;
        case LightKind::point:
            break;
    }
    if (!sun || !light.daylight)
        written[kStrengths[static_cast<size_t>(light.kind)]] = vector(light.strength);
    return written;
}

Json write_box(const SceneBox& box) {
    return {{"min", vector(box.first)}, {"max", vector(box.second)}};
}

Json write_material(const SceneMaterial& material) {
    const SceneMaterial plain;
    Json written = Json::object();
    put(written, "name", material.name, plain.name);
    put(written, "on", material.emits, true);
    put(written, "diffuse", material.diffuse, plain.diffuse);
    put(written, "specular", material.specular, plain.specular);
    put(written, "shininess", material.shininess, plain.shininess);
    put(written, "emission", material.emission, plain.emission);
    if (material.classification) written["class"] = *material.classification;
    if (material.scan) written["scan"] = *material.scan;
    if (material.box) written["box"] = write_box(*material.box);
    return written;
}

Json write_camera(const SceneCamera& camera) {
    Json written = {
        {"name", camera.name}, {"position", vector(camera.position)}, {"target", vector(camera.target)}};
    put(written, "up", camera.up, dvec3(0, 0, 1));
    written["fov"] = degrees_of(camera.vertical_fov);
    put(written, "orthographic_height", camera.orthographic_height, 0.0);
    return written;
}

Json write_sky(const SkySettings& sky, bool has_sun) {
    const SkySettings plain;
    Json written = Json::object();
    put(written, "turbidity", sky.turbidity, plain.turbidity);
    put(written, "ground", sky.ground, plain.ground);
    if (!has_sun) written["direction"] = vector(-sky.sun);
    return written;
}

Json write_environment(const Environment& environment, const Scene& scene,
                       const std::filesystem::path& folder) {
    Json written = Json::object();
    put(written, "on", scene.environment_on, true);
    if (environment.sky) {
        written["sky"] = write_sky(*environment.sky, direction_to_sun(scene.lights).has_value());
        return written;
    }
    if (!environment.image.empty()) {
        const auto seen = std::filesystem::absolute(environment.image)
                              .lexically_normal()
                              .lexically_proximate(std::filesystem::absolute(folder).lexically_normal());
        written["image"] = seen.generic_string();
    }
    written["radiance"] = vector(environment.scale);
    if (environment.rotation != 0) {
        // The rotation is a float: four decimals of a degree are written if they give the same float, else
        // all digits.
        const double degrees = glm::degrees(static_cast<double>(environment.rotation));
        const double rounded = std::round(degrees * 1e4) / 1e4;
        const bool same = static_cast<float>(glm::radians(rounded)) == environment.rotation;
        written["rotation"] = same ? rounded : degrees;
    }
    return written;
}

Json write_exposure(const Scene& scene) {
    Json written = Json::object();
    if (scene.exposure_ev) written["ev"] = *scene.exposure_ev;
    if (scene.tone_map != ToneMap::filmic)
        written["tone_map"] = tone_map_names()[static_cast<size_t>(scene.tone_map)];
    if (scene.white != glm::dvec3(1.0)) written["white"] = {scene.white.x, scene.white.y, scene.white.z};
    if (scene.luminance)
        written["luminance"] = {{"low", scene.luminance->low}, {"high", scene.luminance->high}};
    return written;
}

Json write_comparison(const Comparison& comparison) {
    const Comparison plain;
    Json written = {{"engine", comparison.engine}};
    if (comparison.show != plain.show)
        written["show"] = comparison_names()[static_cast<size_t>(comparison.show)];
    put(written, "border", comparison.border, plain.border);
    put(written, "range", comparison.range, plain.range);
    return written;
}

void put_materials(Json& written, const std::vector<SceneMaterial>& materials) {
    const Json usual = {{"name", "default"}};
    for (size_t i = 0; i < materials.size(); ++i) {
        Json material = write_material(materials[i]);
        if (i > 0 || material != usual) written["materials"].push_back(std::move(material));
    }
}

}  // namespace

std::string write_scene(const Scene& scene, const std::filesystem::path& folder) {
    Json written = Json::object();
    const auto put_object = [&](const char* key, Json object) {
        if (!object.empty()) written[key] = std::move(object);
    };
    put_object("render", write_render_settings(scene.render));
    put_object("exposure", write_exposure(scene));
    if (scene.environment)
        written["environment"] = write_environment(*scene.environment, scene, folder);
    else
        put(written, "background", scene.background, dvec3(0));
    if (scene.lighting_region) written["lighting_region"] = write_box(*scene.lighting_region);
    for (const SceneLight& light : scene.lights) written["lights"].push_back(write_light(light));
    put_materials(written, scene.materials);
    Json albedo = Json::object();
    put(albedo, "scale", scene.albedo.scale, 1.0);
    put(albedo, "flatten", scene.albedo.flatten, 0.0);
    put(albedo, "balance", scene.albedo.balance, true);
    put(albedo, "white", scene.albedo.white, dvec3(1));
    put_object("albedo", albedo);
    put_object("look", write_look(scene.look));
    if (scene.comparison) written["comparison"] = write_comparison(*scene.comparison);
    for (const SceneCamera& camera : scene.cameras) written["cameras"].push_back(write_camera(camera));
    // json_text() repairs names that are not UTF-8, which only files of other programs contain.
    return json_text(written);
}

Result<void> save_scene(const Scene& scene, const std::filesystem::path& path, bool overwrite) {
    return write_file(path, write_scene(scene, path.parent_path().empty() ? "." : path.parent_path()),
                      overwrite);
}

}  // namespace lucarne::gi
