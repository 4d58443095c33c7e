#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gi/scene/scene.h"

namespace lucarne::viewer {

/// A place of a light that can be dragged in the picture.
struct LightHandle {
    enum class Part : uint8_t { position, target, sky } part = Part::position;
    size_t light = 0;
    bool operator==(const LightHandle&) const = default;
};

/// The scene that is in a file or was opened; what is other than that is unsaved.
class SavedScene {
 public:
    /// `version`: ViewModel::scene_version.
    void mark(const gi::Scene& scene, uint64_t version) {
        text_ = gi::write_scene(scene);
        version_ = version;
    }
    /// False also where all changes were taken back.
    bool differs(const gi::Scene& scene, uint64_t version) const {
        return version != version_ && gi::write_scene(scene) != text_;
    }

 private:
    std::string text_;
    uint64_t version_ = 1;
};

/// What the window keeps for lights, albedo, exposure and comparisons beside the scene itself.
struct LightTools {
    bool show_handles = true;
    bool lumens = false;   ///< strengths are shown in lm and lx
    double kelvin = 6500;  ///< of the panel's temperature
    std::optional<LightHandle> held;
    bool holds_border = false;
    std::vector<std::vector<gi::SceneLight>> undo;  ///< the lights as they were, the newest last
    std::string sky_image;                          ///< as typed
    bool load_sky = false;                          ///< it is to be read
    std::string reading_sky, sky_problem;           ///< what is being read; why the last one is not shown
    std::string scene_file;                         ///< what Save scene writes
    bool save_scene = false;
    SavedScene saved;
};

}  // namespace lucarne::viewer
