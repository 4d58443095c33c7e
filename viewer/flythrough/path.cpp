#include "viewer/flythrough/path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "io/files/json.h"

namespace lucarne::viewer {
namespace {

constexpr size_t kMostKeys = 10000;
constexpr double kMostFrames = 1e6;
constexpr double kMostSeconds = 1e5;
constexpr double kFarthest = 1e9;  ///< coordinates of any earthly reference system fit

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

/// Evaluates the curve of one quantity at `time`, which lies in [keys[i].time, keys[i + 1].time].
template <class Get>
auto interpolate(const std::vector<KeyFrame>& keys, size_t i, double time, const Get& get) {
    const auto slope = [&](size_t a, size_t b) {
        return (get(keys[b].camera) - get(keys[a].camera)) / (keys[b].time - keys[a].time);
    };
    // The slope of the parabola through three keys at the middle key.
    const auto tangent = [&](size_t k) {
        if (k == 0) return slope(0, 1);
        if (k + 1 == keys.size()) return slope(k - 1, k);
        const double before = keys[k].time - keys[k - 1].time, after = keys[k + 1].time - keys[k].time;
        return (slope(k - 1, k) * after + slope(k, k + 1) * before) / (before + after);
    };
    const double span = keys[i + 1].time - keys[i].time;
    const double t = (time - keys[i].time) / span, t2 = t * t, t3 = t2 * t;
    return get(keys[i].camera) * (2 * t3 - 3 * t2 + 1) + tangent(i) * ((t3 - 2 * t2 + t) * span) +
           get(keys[i + 1].camera) * (3 * t2 - 2 * t3) + tangent(i + 1) * ((t3 - t2) * span);
}

Result<KeyFrame> read_key(JsonObject& object) {
    const JsonRange place{-kFarthest, kFarthest};
    KeyFrame key;
    LUCARNE_ASSIGN(key.time, object.number("time", {0, kMostSeconds}));
    LUCARNE_ASSIGN(key.camera.position, object.vector("position", place));
    LUCARNE_ASSIGN(key.camera.target, object.vector("target", place));
    LUCARNE_ASSIGN(key.camera.up, object.vector("up", {-1e3, 1e3}, glm::dvec3(0, 0, 1)));
    LUCARNE_ASSIGN(const double fov, object.number("fov", {1, 170}, 60.0));
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
    if (keys.size() == 1 || time <= keys.front().time) return keys.front().camera;
    if (time >= keys.back().time) return keys.back().camera;
    const auto next = std::ranges::upper_bound(keys, time, {}, &KeyFrame::time);
    const size_t i = static_cast<size_t>(next - keys.begin()) - 1;
    gi::SceneCamera camera = keys[i].camera;
    camera.position = interpolate(keys, i, time, [](const gi::SceneCamera& c) { return c.position; });
    camera.target = interpolate(keys, i, time, [](const gi::SceneCamera& c) { return c.target; });
    camera.up = interpolate(keys, i, time, [](const gi::SceneCamera& c) { return c.up; });
    camera.vertical_fov = interpolate(keys, i, time, [](const gi::SceneCamera& c) { return c.vertical_fov; });
    return camera;
}

Result<CameraPath> parse_path(std::string_view text, const std::string& name) {
    LUCARNE_ASSIGN(const nlohmann::json document, parse_json(text, name));
    LUCARNE_ASSIGN(JsonObject root, JsonObject::of(document, name));
    CameraPath path;
    LUCARNE_ASSIGN(path.frames_per_second, root.number("frames_per_second", {0.1, 1000}, 25.0));
    LUCARNE_ASSIGN(std::vector<JsonObject> keys, root.objects("keys", kMostKeys));
    for (JsonObject& object : keys) {
        LUCARNE_ASSIGN(KeyFrame key, read_key(object));
        if (!path.keys.empty() && !(key.time > path.keys.back().time))
            return object.wrong(
                fmt::format("must be later than {} s, the time of the key before", path.keys.back().time),
                "time");
        path.keys.push_back(std::move(key));
    }
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
    return json_text(Json{{"frames_per_second", path.frames_per_second}, {"keys", keys}});
}

Result<CameraPath> load_path(const std::filesystem::path& path) {
    LUCARNE_ASSIGN(const std::string text, load_text(path));
    return parse_path(text, path.string());
}

}  // namespace lucarne::viewer
