#include "viewer/flythrough/path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "gi/scene/scene_limits.h"
#include "io/files/json.h"

namespace lucarne::viewer {
namespace {

constexpr size_t kMostKeys = 10000;
constexpr double kMostFrames = 1e6;
constexpr JsonRange kDegreesOfView{1, 170};

double radians(double degrees) {
    return degrees * std::numbers::pi / 180;
}

/// Returns degrees that convert back to exactly the same angle, the roundest such number. If there is none,
/// returns the nearest double.
double degrees(double angle) {
    const double exact = angle * 180 / std::numbers::pi;
    const double round = std::round(exact * 1e9) / 1e9;
    if (radians(round) == angle) return round;
    double below = exact, above = exact;
    for (int step = 0; step < 4; ++step) {  // rounding errors are smaller than this
        if (radians(below) == angle) return below;
        if (radians(above) == angle) return above;
        below = std::nextafter(below, 0.0);
        above = std::nextafter(above, 360.0);
    }
    return exact;
}

Result<KeyFrame> read_key(JsonObject& object, std::optional<double> before) {
    KeyFrame key;
    LUCARNE_ASSIGN(key.time, read_key_time(object, before));
    LUCARNE_ASSIGN(key.camera.position, object.vector("position", gi::kCoordinate));
    LUCARNE_ASSIGN(key.camera.target, object.vector("target", gi::kCoordinate));
    LUCARNE_ASSIGN(key.camera.up, object.vector("up", {-1e3, 1e3}, glm::dvec3(0, 0, 1)));
    LUCARNE_ASSIGN(const double fov, object.number("fov", kDegreesOfView, 60.0));
    key.camera.vertical_fov = radians(fov);
    LUCARNE_TRY(object.finish());
    if (key.camera.position == key.camera.target) return object.wrong("is where the camera stands", "target");
    const glm::dvec3 ahead = key.camera.target - key.camera.position;
    const double sine = glm::length(glm::cross(glm::normalize(ahead), key.camera.up));
    if (sine < 1e-6) return object.wrong("is zero or points along the view", "up");
    return key;
}

}  // namespace

size_t CameraPath::frames() const {
    return 1 + static_cast<size_t>(std::floor(duration() * frames_per_second * (1 + 1e-12)));
}

gi::SceneCamera CameraPath::at(double time) const {
    const auto on_curve = [&](auto member) {
        return curve_at(keys, time, [&](const KeyFrame& key) { return key.camera.*member; });
    };
    gi::SceneCamera camera = keys[key_before(keys, time)].camera;
    // Curves may leave the ranges of their keys.
    const auto place = [&](auto member) {
        return glm::clamp(on_curve(member), gi::kCoordinate.least, gi::kCoordinate.most);
    };
    camera.position = place(&gi::SceneCamera::position);
    camera.target = place(&gi::SceneCamera::target);
    camera.up = on_curve(&gi::SceneCamera::up);
    camera.vertical_fov = std::clamp(on_curve(&gi::SceneCamera::vertical_fov), radians(kDegreesOfView.least),
                                     radians(kDegreesOfView.most));
    return camera;
}

Result<CameraPath> parse_path(std::string_view text, const std::string& name) {
    LUCARNE_ASSIGN(const nlohmann::json document, parse_json(text, name));
    LUCARNE_ASSIGN(JsonObject root, JsonObject::of(document, name));
    CameraPath path;
    LUCARNE_ASSIGN(path.frames_per_second, root.number("frames_per_second", {0.1, 1000}, 25.0));
    LUCARNE_ASSIGN(std::vector<JsonObject> keys, root.objects("keys", kMostKeys));
    for (JsonObject& object : keys) {
        std::optional<double> before;
        if (!path.keys.empty()) before = path.keys.back().time;
        LUCARNE_ASSIGN(KeyFrame key, read_key(object, before));
        path.keys.push_back(std::move(key));
    }
    LUCARNE_ASSIGN(path.lights, read_light_tracks(root));
    LUCARNE_TRY(root.finish());
    if (path.keys.empty()) return root.wrong("must hold at least one key frame", "keys");
    if (path.duration() * path.frames_per_second > kMostFrames)
        return root.wrong("gives more than a million frames with these times", "frames_per_second");
    return path;
}

std::string path_text(const CameraPath& path) {
    using Json = nlohmann::ordered_json;
    const auto vector = [](const glm::dvec3& v) { return Json{v.x, v.y, v.z}; };
    Json keys = Json::array();
    for (const KeyFrame& key : path.keys)
        keys.push_back({{"time", key.time},
                        {"position", vector(key.camera.position)},
                        {"target", vector(key.camera.target)},
                        {"up", vector(key.camera.up)},
                        {"fov", degrees(key.camera.vertical_fov)}});
    Json text{{"frames_per_second", path.frames_per_second}, {"keys", keys}};
    write_light_tracks(path.lights, text);
    return json_text(text);
}

Result<CameraPath> load_path(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(const std::string text, load_text(path));
    return parse_path(text, path.string());
}

}  // namespace lucarne::viewer
