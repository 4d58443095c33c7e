#include "viewer/window/file_opener.h"

#include <algorithm>
#include <iterator>
#include <system_error>

#include "viewer/scans/scan_set.h"

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

void FileOpener::take_files() {
    std::vector<std::string> files = window_.take_dropped_files();
    const auto add = [&](std::vector<std::string> more) {
        std::ranges::move(more, std::back_inserter(files));
    };
    const Overloaded run{
        [&](const ChooseFiles&) { choose_files(); },
        [&](const OpenFiles& open) { add(open.paths); },
    };
    for (const auto& command : model_.scan_commands.take()) std::visit(run, command);
    if (auto chosen = dialog_.poll()) add(std::move(*chosen));
    if (files.empty()) return;
    for (const std::string& file : files) model_.settings.opened(absolute_path(file));
    settings_.save();
    model_.scans->open(std::move(files));
}

}  // namespace lucarne::viewer
