#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>

#include "io/core/interrupt.h"
#include "viewer/bookmarks/session.h"
#include "viewer/camera/floor_finder.h"
#include "viewer/frame/cost_model.h"
#include "viewer/frame/picture_worker.h"
#include "viewer/frame/quality.h"
#include "viewer/light/session.h"
#include "viewer/measure/session.h"
#include "viewer/publish/session.h"
#include "viewer/scans/scan_set.h"
#include "viewer/style/legend_handles.h"
#include "viewer/window/actions/actions.h"
#include "viewer/window/closing.h"
#include "viewer/window/controller_input.h"
#include "viewer/window/file_opener.h"
#include "viewer/window/kept_project.h"
#include "viewer/window/kept_settings.h"
#include "viewer/window/point_export.h"
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
                ScanSet& scans, InterruptRequest& interrupt, bool keeps_project)
        : window_(window),
          worker_(worker),
          model_(model),
          actions_(bound_actions(model)),
          shot_(std::move(shot)),
          scans_(scans),
          interrupt_(interrupt),
          settings_(window, model),
          files_(window, model, settings_),
          project_(model, shot_           ? KeptProject::Mode::show_only
                          : keeps_project ? KeptProject::Mode::on
                                          : KeptProject::Mode::off),
          closing_(window, model, [this] { return project_.keep(); }),
          bookmarks_([&window](const io::Image8& image) { return window.make_texture(image); },
                     [&window](unsigned texture) { window.free_texture(texture); }),
          quality_(model.view.frame_time, worker.device().software ? kFirstScale : 1),
          publish_([&window] { return window.renew_worker_device(Window::Hidden::rendering); },
                   &Window::wake),
          export_(model, &Window::wake) {}

    /// Runs until the window is closed. `keeps_project`: shows and keeps the user's work on the scan
    /// (viewer/project). If it ends without asking the user (SIGTERM, an error), saves unsaved
    /// work in files with free names. Errors: the scripted shot cannot be made or written, or does not show
    /// all scans; the window is lost; unsaved work cannot be written.
    Result<void> run();

 private:
    using Clock = std::chrono::steady_clock;
    /// Scale of the first moving pictures without a GPU, so that they need not become slow before they become
    /// small.
    static constexpr double kFirstScale = 0.5;

    Result<void> show_until_closed();
    void take_picture();
    void help_in_the_dark(const Picture& picture);
    Result<void> recover();
    void follow_device();
    void follow_scans();
    void take_extent();
    void open_project();
    void open_project_file(const std::filesystem::path& file);
    Result<void> change_project(const std::filesystem::path& file, const std::filesystem::path& folder);
    void open_missing_scans();
    void save_project();
    bool changed_by_user() const;
    void take_input();
    bool take_navigation();
    std::optional<double> floor();
    void follow_bookmarks();
    void draw_panels();
    void send_request();
    std::string unfinished() const;
    Result<void> carry_out();
    void save_picture();
    Result<void> save_shot();
    double seconds_at_rest() const;
    void forget_message();

    Window& window_;
    PictureWorker& worker_;
    ViewModel& model_;
    const std::vector<BoundAction> actions_;
    std::optional<ScriptedShot> shot_;
    ScanSet& scans_;
    InterruptRequest& interrupt_;
    KeptSettings settings_;
    FileOpener files_;
    KeptProject project_;
    Closing closing_;
    BookmarkSession bookmarks_;
    FloorFinder floor_;
    bool placed_ = false;                ///< the starting view has been applied
    Site placed_for_;                    ///< what it was made for
    bool sure_ = false;                  ///< enough points have been seen to be sure of that
    std::vector<uint64_t> shown_scans_;  ///< the ids of the scans that it shows
    bool first_told_ = false;
    ControllerInput controller_{&Window::wake};
    RecoveryTries tries_;
    bool given_up_ = false;  ///< the device is lost for good
    MovingQuality quality_;
    LegendHandles legend_;
    LightSession light_{&Window::wake};
    MeasureSession measure_{&Window::wake};
    PublishSession publish_;
    PointExport export_;
    PictureRequest sent_;
    uint64_t sent_number_ = 0;
    uint64_t own_scene_ = 1;  ///< the scene version before any change by the user
    std::string own_engine_;  ///< with which the window has opened
    uint64_t scene_seen_ = 0, replaced_seen_ = 0;
    bool relit_ = false;            ///< all light was replaced, and nothing has moved since
    bool relit_seen_ = false;       ///< a picture shows the new light
    bool lit_seen_ = false;         ///< a picture at rest has shown the scans lit
    uint32_t whole_pictures_ = 0;   ///< complete pictures in the displayed average
    uint64_t looked_for_dark_ = 0;  ///< the last request whose picture was looked at
    bool is_dark_ = false;          ///< and whether that was dark
    uint32_t idle_frames_ = 0;      ///< frames of the window with nothing open
    std::string message_;           ///< the message that is shown
    Clock::time_point message_since_;
    Clock::time_point last_moving_;  ///< when the last picture of a motion arrived, or the motion began
    Clock::time_point moved_ = Clock::now() - std::chrono::hours(1);
};

}  // namespace lucarne::viewer
