#pragma once

#include <string>

#include "viewer/publish/editor.h"
#include "viewer/publish/render_worker.h"
#include "viewer/ui/command_queue.h"

namespace lucarne::viewer {

// Commands of the actions and panels, with the sizes and files that the model names.
struct SavePath {};
struct LoadPath {};
struct RenderPicture {};
struct RenderFrames {};
struct RenderVideo {};
struct CancelRendering {};

/// Saved pictures and flythroughs.
struct PublishModel {
    PathEditor editor;
    double time = 0;  ///< s on the path: the preview's position
    bool playing = false;
    bool sought = false;  ///< the camera has to move to the preview's position
    bool draw_path = true;

    // Settings of a picture.
    int width = 0, height = 0;  ///< pixels; 0: the window's size at first
    int frames = 8;             ///< averaged
    PictureFinish finish;
    std::string picture_file = "picture.png";
    // Settings of a flight.
    int flight_width = 0, flight_height = 0;  ///< pixels; 0: the window's size at first
    std::string path_file = "flythrough.json";
    std::filesystem::path own_path;  ///< saved or loaded before
    std::string frames_folder = "frames";
    std::string video_file = "flythrough.mp4";

    CommandQueue<SavePath, LoadPath, RenderPicture, RenderFrames, RenderVideo, CancelRendering> commands;
    RenderState rendering;
    std::string message;          ///< message to be shown once
    std::optional<double> typed;  ///< number typed in the field that has the keyboard

    /// Shows an editor's error as the message.
    void take(Result<void> done) {
        if (!done) message = done.error().line();
    }
    /// Saves the path. Overwrites only `own_path`.
    Result<void> save_path(const std::filesystem::path& file);
    /// Replaces the path by a file's and moves the preview to its start.
    Result<void> load_path(const std::filesystem::path& file);
    /// Adds a key frame after the selected one and moves the preview there.
    void add_key(const gi::SceneCamera& camera);
    /// Sets the sizes that have not been chosen yet.
    void set_sizes(int window_width, int window_height);
    /// Plays the preview; starts again at the beginning if the preview is at the end.
    void play();
    /// Advances the preview by `seconds`. It stops at the path's end.
    void advance(double seconds);
    /// Selects a key frame and moves the preview to its time.
    void go_to_key(size_t key);
};

/// Returns at most `most` places along a path for drawing it, world units.
std::vector<glm::dvec3> places_along(const CameraPath& path, size_t most);

}  // namespace lucarne::viewer
