#include "viewer/publish/editor.h"

#include <algorithm>
#include <utility>

#include "io/files/file.h"

namespace lucarne::viewer {
namespace {

constexpr const char* kName = "flythrough";  ///< name of a path without a file in messages

}  // namespace

void PathEditor::select(std::optional<size_t> key) {
    selected_ = key && *key < path().keys.size() ? key : std::nullopt;
}

void PathEditor::become(State state) {
    now_ = std::move(state);
    select(selected_);
}

void PathEditor::put(CameraPath path) {
    become(std::make_shared<const CameraPath>(std::move(path)));
}

/// Takes the path as the reader parses it, so that the path and its file agree exactly.
Result<void> PathEditor::take(CameraPath changed) {
    if (!changed.keys.empty()) {
        LUCARNE_ASSIGN(changed, parse_path(path_text(changed), kName));
    }
    put(std::move(changed));
    return {};
}

Result<void> PathEditor::add(const gi::SceneCamera& camera) {
    if (camera.orthographic_height > 0)
        return failed(kName, "a key frame is a perspective view", "switch the projection");
    CameraPath changed = path();
    auto& keys = changed.keys;
    const size_t at = keys.empty() ? 0 : selected_.value_or(keys.size() - 1) + 1;
    double time = 0;
    if (at > 0) time = at < keys.size() ? (keys[at - 1].time + keys[at].time) / 2 : keys[at - 1].time + kStep;
    keys.insert(keys.begin() + static_cast<std::ptrdiff_t>(at), {time, camera});
    LUCARNE_TRY(take(std::move(changed)));
    selected_ = at;
    return {};
}

Result<void> PathEditor::replace(const gi::SceneCamera& camera) {
    if (!selected_) return {};
    if (camera.orthographic_height > 0)
        return failed(kName, "a key frame is a perspective view", "switch the projection");
    CameraPath changed = path();
    changed.keys[*selected_].camera = camera;
    return take(std::move(changed));
}

Result<void> PathEditor::remove() {
    if (!selected_) return {};
    CameraPath changed = path();
    changed.keys.erase(changed.keys.begin() + static_cast<std::ptrdiff_t>(*selected_));
    const size_t at = *selected_;
    LUCARNE_TRY(take(std::move(changed)));
    select(empty() ? std::nullopt : std::optional(std::min(at, path().keys.size() - 1)));
    return {};
}

Result<void> PathEditor::set_time(double time) {
    if (!selected_) return {};
    CameraPath changed = path();
    KeyFrame key = changed.keys[*selected_];
    key.time = time;
    changed.keys.erase(changed.keys.begin() + static_cast<std::ptrdiff_t>(*selected_));
    const auto place = std::ranges::lower_bound(changed.keys, time, {}, &KeyFrame::time);
    const auto at = static_cast<size_t>(place - changed.keys.begin());
    changed.keys.insert(place, key);
    LUCARNE_TRY(take(std::move(changed)));
    selected_ = at;
    return {};
}

Result<void> PathEditor::set_fov(double radians) {
    if (!selected_) return {};
    CameraPath changed = path();
    changed.keys[*selected_].camera.vertical_fov = radians;
    return take(std::move(changed));
}

Result<void> PathEditor::move(int by) {
    if (!selected_) return {};
    const auto to = static_cast<std::ptrdiff_t>(*selected_) + by;
    if (to < 0 || to >= static_cast<std::ptrdiff_t>(path().keys.size())) return {};
    CameraPath changed = path();
    std::swap(changed.keys[*selected_].camera, changed.keys[static_cast<size_t>(to)].camera);
    LUCARNE_TRY(take(std::move(changed)));
    selected_ = static_cast<size_t>(to);
    return {};
}

Result<void> PathEditor::set_frames_per_second(double rate) {
    CameraPath changed = path();
    changed.frames_per_second = rate;
    if (changed.keys.empty()) return failed(kName, "has no key frame yet", "add one first");
    return take(std::move(changed));
}

Result<void> PathEditor::restore(CameraPath path) {
    LUCARNE_TRY(take(std::move(path)));
    saved_ = now_;
    select(0);
    return {};
}

Result<void> PathEditor::load(const std::filesystem::path& file) {
    LUCARNE_ASSIGN(CameraPath loaded, load_path(file));
    put(std::move(loaded));
    saved_ = now_;
    select(0);
    return {};
}

Result<void> PathEditor::save(const std::filesystem::path& file, bool overwrite) {
    if (empty()) return failed(file.string(), "the flythrough has no key frame yet", "add one first");
    LUCARNE_TRY(write_file(file, path_text(path()), overwrite));
    saved_ = now_;
    return {};
}

}  // namespace lucarne::viewer
