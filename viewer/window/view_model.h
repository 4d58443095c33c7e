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

/// The 6-DoF controller as panels show it; its mapping is in the settings.
struct ControllerModel {
    io::ControllerStatus status;
    io::SixDofState cap;        ///< as it is now
    bool holds_object = false;  ///< the cap is what is looked at, not the camera
};

/// All that the user can change in the viewer, and what the panels show. Actions and panels write it; the
/// session turns it into requests.
struct ViewModel {
    explicit ViewModel(double its_scene_size) : scene_size(its_scene_size), navigation(its_scene_size) {}

    double scene_size;                ///< diagonal, world units
    std::array<glm::dvec3, 2> box{};  ///< of what is open, world units
    CameraRig rig;
    gi::SceneCamera home;  ///< where the view starts
    Navigation navigation;

    gi::Scene scene;
    uint64_t scene_version = 1, shown_changes = 0;
    size_t light = 0;  ///< the selected one
    std::string engine, preset;
    gi::EngineSettings settings;
    CutBudgets budgets;
    double resolution_scale = 1;  ///< of the window's sides, which pictures are made at
    double frame_time = 0.1;      ///< s: what a picture should take while something moves
    PipelineOptions caps;

    Shell shell;  ///< the open scans and what stands around the picture
    MeasureModel measure;
    ShowModel show;

    LookTools look_tools;  ///< beside scene.look
    LightTools light_tools;

    ControllerModel controller;

    Health health;

    bool show_help = false;
    bool close = false, save_picture = false;
    std::string message;                   ///< of the last action, or why there is no new picture
    std::filesystem::path pictures = ".";  ///< the folder for saved ones

    // What is on the screen.
    std::shared_ptr<const Picture> picture;
    gi::DeviceInfo device;
    double scale = 1;  ///< of the picture while moving

    /// Must follow every change of `scene`.
    void scene_changed() { ++scene_version; }
    /// The same where nothing moves and no light is another: exposure, curve, the border of a comparison.
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
