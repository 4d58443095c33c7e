#include "viewer/window/kept_project.h"

#include <utility>

#include "gi/surfels/colouring.h"
#include "io/core/log.h"
#include "io/files/file.h"

namespace lucarne::viewer {
namespace {

constexpr auto kEvery = std::chrono::seconds(3);

Result<void> write(const std::filesystem::path& file, const std::string& text) {
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    if (error) return failed(file.parent_path().string(), "cannot be made: " + error.message());
    return write_file(file, text, true);
}

}  // namespace

bool KeptProject::open(std::vector<std::string> scans, const octree::NodeSource& source) {
    if (!on_ || scans.empty() || !file_.empty()) return false;
    file_ = project_file(config_folder(), scans.front());
    scans_ = std::move(scans);
    LoadedProject loaded = load_project(file_, source.header().metres_per_unit);
    if (!loaded.problem.empty()) log::warn("{}", model_.view.message = loaded.problem);
    if (!loaded.may_write) file_.clear();
    if (!loaded.project) return false;
    Project& project = *loaded.project;
    gi::Scene& scene = project.scene;
    if (!gi::check_attribute(source, scene.look)) scene.look.colour = gi::ColourBy::colour;
    View& view = model_.view;
    show_scene(view, std::move(scene));
    model_.lights.mood = project.mood;
    model_.scene_file.mark(view);
    model_.measure.restore(std::move(project.measurements), source.header().metres_per_unit);
    if (project.flythrough)
        model_.publish.take(model_.publish.editor.restore(std::move(*project.flythrough)));
    changed_ = true;
    saved_ = text();
    log::info("your work on this scan is shown again: {}", file_.string());
    return true;
}

std::string KeptProject::text() const {
    Project project;
    project.scans = scans_;
    project.scene = scene_to_save(model_.view);
    project.mood = model_.lights.mood;
    project.measurements = model_.measure.list.all();
    if (!model_.publish.editor.empty()) project.flythrough = model_.publish.editor.path();
    return project_text(project, model_.measure.metres_per_unit, file_.parent_path());
}

void KeptProject::follow(bool changed) {
    changed_ |= changed;
    if (file_.empty() || !changed_ || Clock::now() - looked_ < kEvery) return;
    looked_ = Clock::now();
    std::string now = text();
    if (now == saved_) return;
    saved_ = now;
    writer_.push(
        "your work", [file = file_, now = std::move(now)] { return write(file, now); },
        [outcome = outcome_](const Result<void>& done) {
            const std::lock_guard lock(outcome->mutex);
            if (!done && !std::exchange(outcome->failed, true)) log::warn("{}", done.error().line());
            if (done) outcome->failed = false;
        });
}

bool KeptProject::keep() {
    if (file_.empty()) return false;
    model_.measure.finish();
    if (!changed_ && model_.measure.list.all().empty() && model_.publish.editor.empty()) return true;
    writer_.finish();
    std::string now = text();
    const std::lock_guard lock(outcome_->mutex);
    if (now == saved_ && !outcome_->failed) return true;
    const auto done = write(file_, now);
    if (!done) log::warn("{}", model_.view.message = done.error().line());
    outcome_->failed = !done;
    if (done) saved_ = std::move(now);
    return done.has_value();
}

}  // namespace lucarne::viewer
