#include "viewer/ui/scene_file.h"

#include "gi/registry.h"
#include "io/files/free_name.h"
#include "viewer/ui/whole_path.h"

namespace lucarne::viewer {

void show_scene(View& view, gi::Scene scene) {
    const gi::RenderSettings& settings = scene.render;
    if (find_preset(settings.preset)) (void)view.choose_preset(settings.preset);
    if (gi::find_engine(settings.engine)) view.method.engine = settings.engine;
    apply(settings, view.method.settings);
    view.resolution_scale = settings.scale.value_or(1);
    if (!scene.cameras.empty()) view.go_to(scene.cameras.front());
    std::erase_if(scene.cameras, [](const gi::SceneCamera& camera) { return camera.name == "view"; });
    view.scene = std::move(scene);
    view.scene_changed();
}

gi::Scene scene_to_save(const View& view) {
    gi::Scene scene = view.scene;
    std::erase_if(scene.cameras, [](const gi::SceneCamera& camera) { return camera.name == "view"; });
    gi::SceneCamera camera = view.rig.camera();
    camera.name = "view";
    if (const auto preset = find_preset(view.preset))
        scene.render = settings_over(*preset, view.method.settings);
    scene.render.engine = view.method.engine;
    scene.render.scale.reset();
    if (view.resolution_scale != 1) scene.render.scale = view.resolution_scale;
    scene.cameras.insert(scene.cameras.begin(), camera);
    return scene;
}

Result<void> SceneFile::open(View& view, const std::filesystem::path& path) {
    LUCARNE_ASSIGN(gi::Scene scene, gi::load_scene(path));
    show_scene(view, std::move(scene));
    path_ = path;
    mark(view);
    return {};
}

void SceneFile::mark(const View& view) {
    saved_ = gi::write_scene(view.scene);
    version_ = view.scene_version;
}

bool SceneFile::differs(const View& view) const {
    return view.scene_version != version_ && gi::write_scene(view.scene) != saved_;
}

std::filesystem::path SceneFile::place(const View& view) const {
    if (!path_.empty()) return path_;
    return free_name(view.pictures, "scene", {".json"}).string() + ".json";
}

Result<void> SceneFile::save_as(const View& view, const std::filesystem::path& path, bool overwrite) {
    LUCARNE_TRY(gi::save_scene(scene_to_save(view), path, overwrite || path == path_));
    path_ = path;
    mark(view);
    return {};
}

void SceneFile::save(View& view) {
    const auto path = place(view);
    const auto saved = save_as(view, path);
    view.message = saved ? "saved " + whole_path(path) : saved.error().line();
}

}  // namespace lucarne::viewer
