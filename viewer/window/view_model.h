#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "io/input/controller.h"
#include "viewer/camera/camera.h"
#include "viewer/camera/navigation.h"
#include "viewer/frame/picture_worker.h"
#include "viewer/frame/presets.h"
#include "viewer/light/tools.h"
#include "viewer/measure/model.h"
#include "viewer/publish/model.h"
#include "viewer/style/look_tools.h"
#include "viewer/window/health.h"
#include "viewer/window/shell.h"

namespace lucarne::viewer {

/// The state of the 6-DoF controller for the panels. Its mapping is in the settings.
struct ControllerModel {
    io::ControllerStatus status;
    io::SixDofState cap;        ///< current deflection
    bool holds_object = false;  ///< the cap moves the object instead of the camera
};

/// Everything that the user can change in the viewer and that the panels show. Actions and panels write it;
/// the session turns it into requests.
struct ViewModel {
    explicit ViewModel(double its_scene_size) : scene_size(its_scene_size), navigation(its_scene_size) {}

    double scene_size;                ///< diagonal, world units
    std::array<glm::dvec3, 2> box{};  ///< bounding box of the open scans, world units
    CameraRig rig;
    gi::SceneCamera home;  ///< the starting view
    Navigation navigation;

    gi::Scene scene;
    uint64_t scene_version = 1, shown_changes = 0;
    size_t light = 0;  ///< index of the selected light
    std::string engine, preset;
    gi::EngineSettings settings;
    CutBudgets budgets;
    double resolution_scale = 1;  ///< share of the window's width and height at which pictures are made
    double frame_time = 0.1;      ///< s: target time of a picture while something moves
    PipelineOptions caps;

    Shell shell;  ///< open scans, files, settings
    MeasureModel measure;
    ShowModel show;

    LookTools look_tools;  ///< in addition to scene.look
    LightTools light_tools;

    ControllerModel controller;

    Health health;

    bool show_help = false;
    bool close = false, save_picture = false;
    std::string message;                   ///< result of the last action, or why there is no new picture
    std::filesystem::path pictures = ".";  ///< the folder for saved pictures

    // What the screen shows.
    std::shared_ptr<const Picture> picture;
    gi::DeviceInfo device;
    double scale = 1;  ///< scale of the picture while something moves

    /// Call after every change of `scene`.
    void scene_changed() { ++scene_version; }
    /// Call instead of scene_changed() after changes that neither move anything nor change light: exposure,
    /// tone curve, the border of a comparison.
    void shown_changed() {
        ++scene_version;
        ++shown_changes;
    }
    SideBar& side_bar() { return shell.settings.side_bar; }
    const SideBar& side_bar() const { return shell.settings.side_bar; }
    gi::SceneLight* selected_light() { return light < scene.lights.size() ? &scene.lights[light] : nullptr; }
    void go_to(const gi::SceneCamera& camera) {
        rig = CameraRig(camera);
        rig.set_clearance(scene_size);
    }
    Result<void> choose_preset(std::string_view name);
};

}  // namespace lucarne::viewer
