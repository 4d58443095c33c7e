#pragma once

#include <string>

#include "viewer/publish/editor.h"
#include "viewer/publish/render_worker.h"

namespace lucarne::viewer {

/// Pictures and flights to show others: that part of the ViewModel.
struct ShowModel {
    PathEditor editor;
    double time = 0;  ///< s, of the path: where the preview is
    bool playing = false;
    bool sought = false;  ///< the camera is to go where the preview is
    bool draw_path = true;

    // A picture.
    int width = 0, height = 0;  ///< pixels; 0: as the window was at first
    int frames = 8;             ///< averaged
    PictureFinish finish;
    std::string picture_file = "picture.png";
    // A flight.
    int flight_width = 0, flight_height = 0;  ///< likewise
    std::string path_file = "flythrough.json";
    std::filesystem::path own_path;  ///< saved or loaded before
    std::string frames_folder = "frames";
    std::string video_file = "flythrough.mp4";

    // Wishes of actions and panels, which the session fulfils.
    enum class Wish { none, save_path, load_path, picture, frames, video, cancel } wish = Wish::none;
    RenderState rendering;
    std::string message;          ///< to be shown once
    std::optional<double> typed;  ///< in the field that has the keyboard

    /// An editor's error becomes the message.
    void take(Result<void> done) {
        if (!done) message = done.error().line();
    }
    /// Writes over its own file alone.
    Result<void> save_path(const std::filesystem::path& file);
    /// Takes the place of the path that there is; the preview is at its start.
    Result<void> load_path(const std::filesystem::path& file);
    /// After the selected key frame; the preview is there.
    void add_key(const gi::SceneCamera& camera);
    /// Sizes that were not chosen yet.
    void set_sizes(int window_width, int window_height);
    /// Starts at the beginning again where the preview is at the end.
    void play();
    /// The preview goes on by so many seconds; it ends at the path's end.
    void advance(double seconds);
    /// Selects a key frame and goes to its time.
    void go_to_key(size_t key);
};

/// What is drawn of a path in a window: places along it, world units, at most `most` of them.
std::vector<glm::dvec3> places_along(const CameraPath& path, size_t most);

}  // namespace lucarne::viewer
