#include "viewer/window/file_opener.h"

#include <algorithm>
#include <iterator>
#include <system_error>
#include <utility>

#include "io/core/log.h"
#include "io/files/json.h"
#include "viewer/project/project.h"
#include "viewer/scans/scan_set.h"
#include "viewer/ui/on_screen.h"

namespace lucarne::viewer {

/// Returns the folder of the last opened file.
std::filesystem::path FileOpener::folder() const {
    const auto& recent = model_.settings.recent;
    if (!recent.empty()) return std::filesystem::path(recent.front()).parent_path();
    std::error_code unknown;
    return std::filesystem::current_path(unknown);
}

void FileOpener::choose_files() {
    if (dialog_.open() || browser_.is_open()) return;
    for (const std::string& program : NativeDialog::programs())
        if (dialog_.start(NativeDialog::command(program, folder().string()))) return;
    browser_.open(folder());
}

/// Lets the desktop's dialog answer where missing scans are.
void FileOpener::choose_folder() {
    MissingScans& question = model_.missing_scans;
    if (std::exchange(question.browses, false) && !folder_dialog_.open()) {
        const std::vector<std::string> programs = NativeDialog::programs();
        const bool started = std::ranges::any_of(programs, [&](const std::string& program) {
            return folder_dialog_.start(NativeDialog::folder_command(program, question.folder));
        });
        if (!started) question.problem = "No file dialog (zenity or kdialog) is installed.";
    }
    const auto chosen = folder_dialog_.poll();
    if (chosen && !chosen->empty() && question.shown) question.answer = question.folder = chosen->front();
}

/// Shows the scene of a file. Errors: those of the file; there is no scan to show it on.
Result<void> FileOpener::open_scene(const std::string& file) {
    LUCARNE_TRY(load_json(file));
    if (!model_.scans->source()) return failed(file, "is a scene", "open a scan first");
    return model_.scene_file.open(model_.view, file);
}

/// Shows the scenes among the files, and takes them out of the list.
void FileOpener::open_scenes(std::vector<std::string>& files) {
    const auto is_scene = [](const std::string& file) {
        return std::filesystem::path(file).extension() == ".json";
    };
    for (const std::string& file : files) {
        if (!is_scene(file)) continue;
        if (is_project(file)) {
            model_.commands.push(OpenProject{file});
            continue;
        }
        const auto done = open_scene(file);
        if (done) model_.lights.mood.reset();
        model_.view.message = done ? "opened " + absolute_path(file) : done.error().line();
        log::info("{}", model_.view.message);
    }
    std::erase_if(files, is_scene);
}

void FileOpener::look_at(const std::array<glm::dvec3, 2>& box) {
    CameraRig rig = model_.view.rig;
    rig.fit(widened(box, 0, kLeastBox / model_.view.site.metres_per_unit),
            picture_shape(model_.view.side_bar));
    model_.view.glide_to(rig.camera());
}

/// Saves the scene once the user has named a file.
void FileOpener::save_scene() {
    FileQuestion& question = model_.scene_name;
    const auto answer = question.take_answer();
    if (!answer) return;
    const std::string file = absolute_path(answer->file.string());
    const auto saved = model_.scene_file.save_as(model_.view, file, answer->overwrite);
    question.problem = saved ? "" : saved.error().line();
    if (!saved) return;
    question.shown = false;
    model_.view.message = "saved " + file;
    log::info("{}", model_.view.message);
}

void FileOpener::take_files() {
    save_scene();
    choose_folder();
    std::vector<std::string> files = window_.take_dropped_files();
    const auto add = [&](std::vector<std::string> more) {
        std::ranges::move(more, std::back_inserter(files));
    };
    const Overloaded run{
        [&](const ChooseFiles&) { choose_files(); },
        [&](const OpenFiles& open) { add(open.paths); },
        [&](const LookAtScan& scan) { look_at(scan.box); },
    };
    for (const auto& command : model_.scan_commands.take()) std::visit(run, command);
    if (auto chosen = dialog_.poll()) add(std::move(*chosen));
    open_scenes(files);
    if (files.empty()) return;
    for (const std::string& file : files) model_.settings.opened(absolute_path(file));
    settings_.save();
    model_.scans->open(std::move(files));
}

}  // namespace lucarne::viewer
