#pragma once

#include <filesystem>
#include <string>

#include "io/input/controller.h"
#include "viewer/bookmarks/bookmarking.h"
#include "viewer/light/lighting.h"
#include "viewer/measure/measuring.h"
#include "viewer/project/missing_scans.h"
#include "viewer/publish/publishing.h"
#include "viewer/rendering/rendering.h"
#include "viewer/scans/scan_commands.h"
#include "viewer/stations/stations.h"
#include "viewer/style/styling.h"
#include "viewer/ui/command_queue.h"
#include "viewer/ui/file_question.h"
#include "viewer/ui/scene_file.h"
#include "viewer/ui/view.h"
#include "viewer/window/health.h"
#include "viewer/window/settings/settings.h"
#include "viewer/window/undo_history.h"

namespace lucarne::viewer {

/// The state of the 6-DoF controller for the panels. Its mapping is in the settings.
struct ControllerModel {
    io::ControllerStatus status;
    io::SixDofState cap;        ///< current deflection
    bool holds_object = false;  ///< the cap moves the object instead of the camera
};

// Commands of the menu "File".
struct SaveScene {};
struct SavePicture {};  ///< as the window shows it
struct Close {};        ///< after asking, if work is unsaved
struct OpenProject {
    std::filesystem::path file;
};

// Answers to the question before closing.
struct SaveAndClose {};
struct DiscardAndClose {};

/// The question where to export points to, and how many of them.
struct ExportChoice {
    FileQuestion name;
    double spacing = 0;  ///< metres; 0: all points
    int every = 1;
    bool cancel = false;  ///< the user cancels the export
    bool running = false;
};

struct ClosingQuestion {
    bool shown = false;
    bool kept = false;    ///< the project keeps the work: nothing would be lost
    std::string problem;  ///< why saving failed
    CommandQueue<SaveAndClose, DiscardAndClose> answers;
};

/// Everything that the user can change in the viewer and that the panels show: what all features share, and
/// the model of each feature. Actions and panels write it; the session turns it into requests.
struct ViewModel {
    explicit ViewModel(double scene_size) : view(scene_size) {}

    View view;
    SceneFile scene_file;
    BookmarkModel bookmarks;
    LookModel look;
    LightModel lights;
    MeasureModel measure;
    PublishModel publish;
    StationModel stations;
    bool holds_border = false;  ///< the mouse drags a comparison's border

    ScanSet* scans = nullptr;  ///< the open scans; outlive the model
    ScanCommands scan_commands;
    CommandQueue<SaveScene, SavePicture, Close, OpenProject> commands;
    FileQuestion scene_name;     ///< the scene's file, as asked for by "Save scene as..."
    FileQuestion project_name;   ///< the project's file, as asked for by "Save project as..."
    MissingScans missing_scans;  ///< of the project that was opened last
    ExportChoice exporting;
    ClosingQuestion closing;
    Settings settings;  ///< of the window; its side bar's are in `view`
    ControllerModel controller;
    Health health;
    bool show_help = false, show_about = false;
    UndoHistory history;

    // What each feature's actions and panels act on. The model must outlive them, and stay where it is.
    Bookmarking bookmarking() { return {view, bookmarks}; }
    Styling styling() { return {view, look}; }
    Lighting lighting() { return {view, lights}; }
    Rendering rendering() { return {view, holds_border}; }
    Measuring measuring() { return {view, measure}; }
    Publishing publishing() { return {view, publish}; }
    Stations stationing() { return {view, stations}; }
};

}  // namespace lucarne::viewer
