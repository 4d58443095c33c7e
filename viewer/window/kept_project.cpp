#include "viewer/window/kept_project.h"

#include <utility>

#include "gi/surfels/colouring.h"
#include "io/core/log.h"
#include "io/files/file.h"
#include "viewer/scans/scan_set.h"

namespace lucarne::viewer {
namespace {

constexpr auto kEvery = std::chrono::seconds(3);

Result<void> make_folder_of(const std::filesystem::path& file) {
    if (!file.has_parent_path()) return {};
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    if (error) return failed(file.parent_path().string(), "cannot be made: " + error.message());
    return {};
}

Result<void> write(const std::filesystem::path& file, const std::string& text) {
    LUCARNE_TRY(make_folder_of(file));
    return write_file(file, text, true);
}

}  // namespace

void KeptProject::use(std::filesystem::path file, std::vector<std::string> missing) {
    close();
    if (mode_ == Mode::off) mode_ = Mode::on;
    file_ = std::move(file);
    missing_ = std::move(missing);
    named_ = true;
}

/// Keeps other windows from writing the file, or this one if another window has it open.
void KeptProject::lock() {
    if (!named_) (void)make_folder_of(file_);  // if it fails, the first save reports it
    const std::string holder = lock_.take(file_);
    if (holder.empty()) return;
    model_.view.message = "open in another window (" + holder + "); Save project as keeps changes";
    log::warn("{}: {}", file_.string(), model_.view.message);
    file_.clear();
}

bool KeptProject::open(const octree::NodeSource& source) {
    note_scans();
    if (scans_.empty() || (!named_ && (mode_ != Mode::on || !file_.empty()))) return false;
    if (!named_) file_ = project_file(config_folder(), scans_.front().front());
    if (file_.empty()) return false;
    const std::filesystem::path file = file_;
    const double metres_per_unit = source.header().metres_per_unit;
    LoadedProject loaded;
    if (!named_) {
        loaded = load_project(file, metres_per_unit);
    } else if (auto project = read_project(file, metres_per_unit)) {
        loaded.project = std::move(*project);
        loaded.problem = missing_text(file, missing_);
    } else {
        loaded.problem = project.error().line();
        loaded.may_write = false;
    }
    if (!loaded.problem.empty()) log::warn("{}", model_.view.message = loaded.problem);
    if (mode_ == Mode::show_only || !loaded.may_write)
        file_.clear();
    else
        lock();
    if (!loaded.project) return false;
    show(std::move(*loaded.project), source);
    changed_ = true;
    saved_ = text(file.parent_path());
    log::info("your work on this scan is shown again: {}", file.string());
    return true;
}

void KeptProject::show(Project project, const octree::NodeSource& source) {
    gi::Scene& scene = project.scene;
    if (!gi::check_attribute(source, scene.look)) scene.look.colour = gi::ColourBy::colour;
    View& view = model_.view;
    show_scene(view, std::move(scene));
    model_.lights.mood = project.mood;
    model_.scene_file.mark(view);
    model_.measure.restore(std::move(project.measurements), source.header().metres_per_unit);
    if (project.flythrough)
        model_.publish.take(model_.publish.editor.restore(std::move(*project.flythrough)));
}

void KeptProject::note_scans() {
    const std::vector<ScanRow>& rows = model_.scans->rows();
    if (rows.empty()) return;
    scans_.clear();
    for (const ScanRow& row : rows) {
        std::vector<std::string>& group = scans_.emplace_back();
        for (const std::string& path : row.paths) group.push_back(absolute_path(path));
    }
    for (const std::string& path : missing_) scans_.push_back({path});
}

std::string KeptProject::text(const std::filesystem::path& folder) {
    note_scans();
    Project project;
    project.scans = scans_;
    project.scene = scene_to_save(model_.view);
    project.mood = model_.lights.mood;
    project.measurements = model_.measure.list.all();
    if (!model_.publish.editor.empty()) project.flythrough = model_.publish.editor.path();
    return project_text(project, model_.measure.metres_per_unit, folder);
}

void KeptProject::follow(bool changed) {
    {
        const std::lock_guard lock(outcome_->mutex);
        if (!outcome_->problem.empty()) model_.view.message = std::exchange(outcome_->problem, {});
    }
    changed_ |= changed;
    if (file_.empty() || !changed_ || Clock::now() - looked_ < kEvery) return;
    looked_ = Clock::now();
    std::string now = text(file_.parent_path());
    if (now == saved_) return;
    saved_ = now;
    writer_.push(
        "your work", [file = file_, now = std::move(now)] { return write(file, now); },
        [outcome = outcome_](const Result<void>& done) {
            const std::lock_guard lock(outcome->mutex);
            if (!done && !std::exchange(outcome->failed, true))
                log::warn("{}", outcome->problem = "your work is not kept: " + done.error().line());
            if (done) outcome->failed = false;
        });
}

bool KeptProject::keep() {
    if (file_.empty()) return false;
    model_.measure.finish();
    if (!changed_ && model_.measure.list.all().empty() && model_.publish.editor.empty()) return true;
    writer_.finish();
    std::string now = text(file_.parent_path());
    const std::lock_guard lock(outcome_->mutex);
    if (now == saved_ && !outcome_->failed) return true;
    const auto done = write(file_, now);
    if (!done) log::warn("{}", model_.view.message = done.error().line());
    outcome_->failed = !done;
    if (done) saved_ = std::move(now);
    return done.has_value();
}

void KeptProject::close() {
    keep();
    file_.clear();
    missing_.clear();
    named_ = changed_ = false;
    lock_.release();
}

Result<void> KeptProject::save_as(const std::filesystem::path& file, bool overwrite) {
    if (!model_.scans->source()) return failed(file.string(), "no scan is open", "open one first");
    const bool same = file == file_;
    ProjectLock lock;
    if (const std::string holder = same ? "" : lock.take(file); !holder.empty())
        return failed(file.string(), "is open in another window (" + holder + ")", "give another name");
    model_.measure.finish();
    writer_.finish();
    std::string now = text(file.parent_path());
    LUCARNE_TRY(write_file(file, now, overwrite || same));
    if (!same) lock_ = std::move(lock);
    file_ = file;
    saved_ = std::move(now);
    mode_ = Mode::on;
    named_ = changed_ = true;
    const std::lock_guard guard(outcome_->mutex);
    outcome_->failed = false;
    return {};
}

}  // namespace lucarne::viewer
