#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include <glm/vector_relational.hpp>

#include "gi/scene/sky_model.h"
#include "viewer/camera/camera.h"
#include "viewer/camera/glide.h"
#include "viewer/camera/navigation.h"
#include "viewer/frame/picture_worker.h"
#include "viewer/frame/presets.h"
#include "viewer/opening/site.h"
#include "viewer/ui/side_bar.h"

namespace lucarne::viewer {

/// What all features of the window share: the scene, the camera, how pictures are made, and the newest
/// picture. Actions and panels write it; the session turns it into requests.
struct View {
    explicit View(double its_scene_size) : scene_size(its_scene_size), navigation(its_scene_size) {}

    double scene_size;                ///< diagonal, world units
    std::array<glm::dvec3, 2> box{};  ///< bounding box of the open scans, world units
    CameraRig rig;
    CameraGlide glide;
    gi::SceneCamera home;  ///< the starting view
    Site site;             ///< what the open scans show
    Navigation navigation;
    bool entered = false;  ///< the user has gone inside
    /// What prepared_engine() computes in advance is known for the open scans.
    bool is_prepared = false;
    BakeProgress preparing;  ///< what is being computed in advance

    gi::Scene scene;
    uint64_t scene_version = 1, shown_changes = 0;
    uint64_t replaced = 0;  ///< scene_version when all light was replaced last
    Method method;
    std::string preset;
    double resolution_scale = 1;  ///< share of the window's width and height at which pictures are made
    double frame_time = 0.1;      ///< s: target time of a picture while something moves
    PipelineOptions caps;

    SideBar side_bar;
    std::string message;                   ///< result of the last action, or why there is no new picture
    std::filesystem::path pictures = ".";  ///< the folder for saved pictures

    // What the screen shows.
    std::shared_ptr<const Picture> picture;
    gi::DeviceInfo device;
    double scale = 1;  ///< scale of the picture while something moves

    /// Call after every change of `scene`. Daylight follows the sun.
    void scene_changed() {
        gi::update_daylight(scene);
        ++scene_version;
    }
    /// Call instead of scene_changed() after changes that neither move anything nor change light: exposure,
    /// tone curve, the border of a comparison.
    void shown_changed() {
        ++scene_version;
        ++shown_changes;
    }
    /// Call after all light was replaced at once, which is no motion: the last picture stays until there is
    /// one with all of the new light.
    void light_replaced() {
        scene_changed();
        replaced = scene_version;
    }
    void go_to(const gi::SceneCamera& camera) {
        glide.stop();
        rig = CameraRig(camera);
        rig.set_clearance(scene_size);
    }
    /// Whether the camera stands in a room of the scan, as opposed to looking at it from outside.
    bool inside() const {
        const glm::dvec3& eye = rig.position();
        return site.inside && (entered || site.kind == SiteKind::interior) && !rig.orthographic() &&
               glm::all(glm::greaterThan(eye, site.box[0])) && glm::all(glm::lessThan(eye, site.box[1]));
    }
    /// Moves there smoothly, frame by frame (advance()).
    void glide_to(const gi::SceneCamera& camera) { glide.start(rig.camera(), camera); }
    /// Moves the camera on its way. Returns whether it moved.
    bool advance(double seconds) {
        const auto camera = glide.advance(seconds);
        if (!camera) return false;
        rig = CameraRig(*camera);
        rig.set_clearance(scene_size);
        return true;
    }
    /// Takes a preset's settings and budgets. Errors: no preset has this name.
    Result<void> choose_preset(std::string_view name);
};

}  // namespace lucarne::viewer
