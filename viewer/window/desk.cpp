#include "viewer/window/desk.h"

#include <algorithm>
#include <iterator>
#include <system_error>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "io/core/log.h"
#include "viewer/window/panels/panels.h"
#include "viewer/window/unsaved.h"

namespace lucarne::viewer {
namespace {

std::string absolute(const std::string& path) {
    std::error_code unknown;
    const auto whole = std::filesystem::absolute(path, unknown);
    return unknown ? path : whole.lexically_normal().string();
}

}  // namespace

/// Saves settings and bookmarks at the end. Reports failures on the terminal, because the window is gone.
Desk::~Desk() {
    model_.shell.settings.window = window_.size();
    model_.shell.settings.navigation = navigation_name(model_.navigation.mode());
    if (const auto saved = save_settings(model_.shell.settings, config_folder()); !saved)
        log::warn("{}", saved.error().line());
}

/// Saves the settings on a thread, since a disk may be slow.
void Desk::remember() {
    writer_.push("the settings", [settings = model_.shell.settings, folder = config_folder()] {
        return save_settings(settings, folder);
    });
}

/// Returns the folder of the last opened file.
std::filesystem::path Desk::folder() const {
    const auto& recent = model_.shell.settings.recent;
    if (!recent.empty()) return std::filesystem::path(recent.front()).parent_path();
    std::error_code unknown;
    return std::filesystem::current_path(unknown);
}

void Desk::choose_files() {
    if (dialog_.open() || browser_.is_open()) return;
    for (const std::string& program : NativeDialog::programs())
        if (dialog_.start(NativeDialog::command(program, folder().string()))) return;
    browser_.open(folder());
}

void Desk::take_files() {
    Shell& shell = model_.shell;
    if (std::exchange(shell.want_file, false)) choose_files();
    std::vector<std::string> files = window_.take_dropped_files();
    const auto add = [&](std::vector<std::string> more) {
        std::ranges::move(more, std::back_inserter(files));
    };
    add(std::exchange(shell.to_open, {}));
    if (auto chosen = dialog_.poll()) add(std::move(*chosen));
    if (files.empty()) return;
    for (const std::string& file : files) shell.settings.opened(absolute(file));
    remember();
    scans_.open(std::move(files));
}

/// Loads and saves bookmarks. They belong to the scan that was opened first.
void Desk::follow_bookmarks() {
    Shell& shell = model_.shell;
    const auto& rows = scans_.rows();
    const auto of = rows.empty() ? std::filesystem::path()
                                 : bookmark_folder(config_folder(), absolute(rows.front().paths.front()));
    if (of != bookmarks_of_) {
        for (const Bookmark& bookmark : shell.bookmarks) window_.free_texture(bookmark.texture);
        shell.bookmarks.clear();
        bookmarks_of_ = of;
        if (!of.empty())
            writer_.push(
                "the bookmarks", [of]() -> Result<LoadedBookmarks> { return load_bookmarks(of); },
                [read = read_, of](Result<LoadedBookmarks> loaded) {
                    const std::lock_guard lock(read->mutex);
                    read->bookmarks =
                        loaded ? std::move(*loaded) : LoadedBookmarks{of, {}, loaded.error().line()};
                });
    }
    std::optional<LoadedBookmarks> loaded;
    {
        const std::lock_guard lock(read_->mutex);
        loaded.swap(read_->bookmarks);
    }
    if (loaded && loaded->folder == bookmarks_of_) {
        if (!loaded->problem.empty()) log::warn("{}", model_.message = loaded->problem);
        shell.bookmarks.insert(shell.bookmarks.begin(), std::make_move_iterator(loaded->bookmarks.begin()),
                               std::make_move_iterator(loaded->bookmarks.end()));
    }
    for (Bookmark& bookmark : shell.bookmarks)
        if (!bookmark.texture && bookmark.thumbnail.width)
            bookmark.texture = window_.make_texture(bookmark.thumbnail);
    for (const unsigned texture : std::exchange(shell.stale_textures, {})) window_.free_texture(texture);
    if (!std::exchange(shell.bookmarks_changed, false)) return;
    writer_.push("the bookmarks", [bookmarks = shell.bookmarks, folder = bookmarks_of_] {
        return save_bookmarks(bookmarks, folder);
    });
}

std::optional<double> Desk::floor() {
    const double eye = model_.navigation.eye_height();
    if (model_.navigation.mode() != NavigationMode::walk || !model_.navigation.gravity()) return std::nullopt;
    floor_.look(scans_.source(), model_.rig.position(), eye);
    return floor_.found();
}

void Desk::draw() {
    follow_bookmarks();
    draw_menu_bar(model_);
    if (scans_.rows().empty()) draw_start_page(model_);
    draw_file_browser(model_, browser_);
    draw_closing_question(model_);
}

/// Returns why the user must be asked before closing; empty if nothing would be lost.
std::string Desk::reason_to_ask() const {
    std::string all;
    for (const Unsaved& one : unsaved(model_)) all += (all.empty() ? "not saved: " : ", ") + one.what;
    const auto add = [&](std::string_view reason) { all += (all.empty() ? "" : "; ") + std::string(reason); };
    if (model_.show.rendering.running) add("a picture or flight is being rendered");
    if (scans_.converting()) add("a scan is being converted");
    return all;
}

bool Desk::closing(bool at_once) {
    Shell& shell = model_.shell;
    if (std::exchange(shell.save_to_close, false)) {
        const auto saved = save_unsaved(model_);
        shell.closing_problem = saved ? "" : saved.error().line();
        shell.close_now = saved.has_value();
    }
    if (!model_.close && !window_.closing()) return shell.close_now;
    const std::string reason = at_once ? "" : reason_to_ask();
    if (reason.empty()) return true;
    model_.close = false;
    window_.stay();
    shell.closing_problem.clear();
    if (!std::exchange(shell.ask_to_close, true)) log::info("{}: asked whether to close anyway", reason);
    return false;
}

void Desk::answer(std::span<const KeyChord> keys) {
    Shell& shell = model_.shell;
    for (const KeyChord& chord : keys) {
        if (!shell.ask_to_close) return;
        const bool enter = chord.key == GLFW_KEY_ENTER || chord.key == GLFW_KEY_KP_ENTER;
        const bool save = enter && !unsaved(model_).empty();
        const bool discard = chord.key == GLFW_KEY_D && chord.modifiers == GLFW_MOD_CONTROL;
        if (chord.key == GLFW_KEY_ESCAPE) shell.ask_to_close = false;
        shell.save_to_close |= save;
        shell.close_now |= discard || (enter && !save);
    }
}

}  // namespace lucarne::viewer
