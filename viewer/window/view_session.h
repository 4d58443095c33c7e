#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>

#include "io/core/interrupt.h"
#include "viewer/frame/cost_model.h"
#include "viewer/frame/picture_worker.h"
#include "viewer/frame/quality.h"
#include "viewer/light/sky_loader.h"
#include "viewer/measure/session.h"
#include "viewer/publish/session.h"
#include "viewer/scans/scan_set.h"
#include "viewer/style/legend_handles.h"
#include "viewer/window/controller_input.h"
#include "viewer/window/desk.h"
#include "viewer/window/view_model.h"
#include "viewer/window/window.h"

namespace lucarne::viewer {

/// A screenshot for scripts. Saves the window once it shows the average of exactly `pictures` complete
/// pictures, which is the same on every run, and closes the window. With nothing open, saves the start page
/// once it has its final size.
struct ScriptedShot {
    std::filesystem::path file;
    uint32_t pictures = 1;
    bool overwrite = false;
};

/// The window's main loop: applies input to the model, sends requests made from the model, and shows
/// pictures.
class ViewSession {
 public:
    ViewSession(Window& window, PictureWorker& worker, ViewModel& model, std::optional<ScriptedShot> shot,
                ScanSet& scans, InterruptRequest& interrupt)
        : window_(window),
          worker_(worker),
          model_(model),
          shot_(std::move(shot)),
          scans_(scans),
          interrupt_(interrupt),
          desk_(window, model, scans),
          quality_(model.frame_time),
          budget_(model.frame_time),
          show_([&window] { return window.renew_worker_device(Window::Hidden::rendering); }, &Window::wake) {}

    /// Runs until the window is closed. If it ends without asking the user (SIGTERM, an error), saves unsaved
    /// work in files with free names. Errors: the scripted shot cannot be made or written, or does not show
    /// all scans; the window is lost; unsaved work cannot be written.
    Result<void> run();

 private:
    using Clock = std::chrono::steady_clock;

    Result<void> show_until_closed();
    void take_picture();
    Result<void> recover();
    void follow_device();
    void follow_scans();
    void follow_sky();
    void take_extent();
    void take_input();
    void take_light_gesture();
    bool take_navigation();
    void draw_panels();
    void send_request();
    std::string unfinished() const;
    Result<void> save();
    Result<void> save_shot();
    double seconds_at_rest() const;

    Window& window_;
    PictureWorker& worker_;
    ViewModel& model_;
    std::optional<ScriptedShot> shot_;
    ScanSet& scans_;
    InterruptRequest& interrupt_;
    Desk desk_;
    bool placed_ = false;  ///< the starting view has been applied
    bool first_told_ = false;
    ControllerInput controller_{&Window::wake};
    RecoveryTries tries_;
    bool given_up_ = false;  ///< the device is lost for good
    MovingQuality quality_;
    FrameBudget budget_;
    LegendHandles legend_;
    SkyLoader skies_{&Window::wake};
    MeasureSession measure_{&Window::wake};
    ShowSession show_;
    PictureRequest sent_;
    uint64_t sent_number_ = 0;
    uint64_t own_scene_ = 1;  ///< the scene version before any change by the user
    uint64_t scene_seen_ = 0;
    uint32_t whole_pictures_ = 0;  ///< complete pictures in the displayed average
    uint32_t idle_frames_ = 0;     ///< frames of the window with nothing open
    Clock::time_point moved_ = Clock::now() - std::chrono::hours(1);
};

}  // namespace lucarne::viewer
