#include "viewer/publish/model.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace lucarne::viewer {

void PublishModel::set_sizes(int window_width, int window_height) {
    for (const auto& [wide, high] : {std::pair(&width, &height), std::pair(&flight_width, &flight_height)}) {
        if (*wide > 0) continue;
        *wide = window_width;
        *high = window_height;
    }
}

Result<void> PublishModel::save_path(const std::filesystem::path& file) {
    LUCARNE_TRY(editor.save(file, file == own_path));
    own_path = file;
    return {};
}

Result<void> PublishModel::load_path(const std::filesystem::path& file) {
    LUCARNE_TRY(editor.load(file));
    own_path = file;
    time = editor.path().start();
    return {};
}

void PublishModel::add_key(const gi::SceneCamera& camera) {
    const auto added = editor.add(camera);
    if (!added) return take(added);
    time = editor.path().keys[*editor.selected()].time;
    message = fmt::format("key frame {} of {}", *editor.selected() + 1, editor.path().keys.size());
}

void PublishModel::play() {
    playing = !playing && !editor.empty();
    if (playing && time >= editor.path().keys.back().time) time = editor.path().start();
}

void PublishModel::advance(double seconds) {
    if (editor.empty()) playing = false;
    if (!playing) return;
    const double end = editor.path().keys.back().time;
    time = std::clamp(time + seconds, editor.path().start(), end);
    playing = time < end;
    sought = true;
}

void PublishModel::go_to_key(size_t key) {
    if (key >= editor.path().keys.size()) return;
    editor.select(key);
    time = editor.path().keys[key].time;
    sought = true;
}

std::vector<glm::dvec3> places_along(const CameraPath& path, size_t most) {
    constexpr size_t kBetweenKeys = 24;
    std::vector<glm::dvec3> places;
    if (path.keys.empty() || most < 2) return places;
    const size_t steps = std::min(kBetweenKeys * (path.keys.size() - 1), most - 1);
    for (size_t i = 0; i <= steps; ++i) {
        const double share = steps ? static_cast<double>(i) / static_cast<double>(steps) : 0;
        places.push_back(path.at(path.start() + path.duration() * share).position);
    }
    return places;
}

}  // namespace lucarne::viewer
