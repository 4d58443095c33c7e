#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gi/scene/scene.h"

namespace lucarne::viewer {

/// A part of a light that can be dragged in the picture.
struct LightHandle {
    enum class Part : uint8_t { position, target, sky } part = Part::position;
    size_t light = 0;
    bool operator==(const LightHandle&) const = default;
};

/// The scene as it was last saved or opened. Differences from it are unsaved changes.
class SavedScene {
 public:
    /// `version`: ViewModel::scene_version.
    void mark(const gi::Scene& scene, uint64_t version) {
        text_ = gi::write_scene(scene);
        version_ = version;
    }
    /// Whether the scene has unsaved changes. False if all changes were undone.
    bool differs(const gi::Scene& scene, uint64_t version) const {
        return version != version_ && gi::write_scene(scene) != text_;
    }

 private:
    std::string text_;
    uint64_t version_ = 1;
};

/// What the window remembers for lights, albedo, exposure and comparisons in addition to the scene.
struct LightTools {
    bool show_handles = true;
    bool lumens = false;   ///< show strengths in lm and lx
    double kelvin = 6500;  ///< the panel's colour temperature
    std::optional<LightHandle> held;
    bool holds_border = false;
    std::vector<std::vector<gi::SceneLight>> undo;  ///< earlier states of the lights, the newest last
    std::string sky_image;                          ///< path of the sky picture, as typed
    bool load_sky = false;                          ///< request to read it
    std::string reading_sky, sky_problem;  ///< the path being read; why the last picture is not shown
    std::string scene_file;                ///< the file that "Save scene" writes
    bool save_scene = false;
    SavedScene saved;
};

}  // namespace lucarne::viewer
