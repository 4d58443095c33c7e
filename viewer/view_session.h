#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

#include "viewer/cost_model.h"
#include "viewer/picture_worker.h"
#include "viewer/quality.h"
#include "viewer/view_model.h"
#include "viewer/window.h"

namespace lucarne::viewer {

/// For scripts: the window's own picture is saved once `pictures` whole ones were shown at rest, and the
/// window closes.
struct ScriptedShot {
    std::filesystem::path file;
    uint32_t pictures = 1;
    bool overwrite = false;
};

/// The loop of the window: input into the model, the model into requests, pictures onto the screen.
class ViewSession {
 public:
    ViewSession(Window& window, PictureWorker& worker, ViewModel& model, std::optional<ScriptedShot> shot)
        : window_(window),
          worker_(worker),
          model_(model),
          shot_(std::move(shot)),
          quality_(model.frame_time),
          budget_(model.frame_time) {}

    /// Until the window is closed. Errors: the scripted shot cannot be made or written.
    Result<void> run();

 private:
    using Clock = std::chrono::steady_clock;

    void take_picture();
    void take_input();
    void take_light_gesture();
    bool take_navigation();
    void draw_panels();
    void send_request();
    Result<void> save();
    double seconds_at_rest() const;

    Window& window_;
    PictureWorker& worker_;
    ViewModel& model_;
    std::optional<ScriptedShot> shot_;
    MovingQuality quality_;
    FrameBudget budget_;
    PictureRequest sent_;
    uint64_t sent_number_ = 0;
    uint64_t scene_seen_ = 0;
    uint32_t whole_pictures_ = 0;
    Clock::time_point moved_ = Clock::now() - std::chrono::hours(1);
};

}  // namespace lucarne::viewer
