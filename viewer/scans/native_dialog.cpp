#include "viewer/scans/native_dialog.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/core/process.h"
#include "viewer/inputs/scan_list.h"

namespace lucarne::viewer {
namespace {

constexpr size_t kMostOutput = size_t{1} << 20;  ///< bytes

std::string patterns() {
    std::string all = "*.luc *.json";
    for (const auto extension : scan_extensions()) {
        std::string upper(extension);
        std::ranges::transform(upper, upper.begin(),
                               [](char c) { return c >= 'a' && c <= 'z' ? c - 32 : c; });
        all += " *" + std::string(extension) + " *" + upper;
    }
    return all;
}

}  // namespace

std::vector<std::string> NativeDialog::programs() {
    const char* desktop = std::getenv("XDG_CURRENT_DESKTOP");
    std::vector<std::string> names = {"zenity", "kdialog"};
    if (desktop && std::string(desktop).find("KDE") != std::string::npos) std::swap(names[0], names[1]);
    std::erase_if(names, [](const std::string& name) { return !program_installed(name); });
    return names;
}

std::vector<std::string> NativeDialog::command(const std::string& program, const std::string& folder) {
    if (program == "kdialog")
        return {"kdialog",           "--title",           "Open scans", "--multiple",
                "--separate-output", "--getopenfilename", folder,       patterns() + " | Scans and scenes"};
    return {"zenity",
            "--file-selection",
            "--multiple",
            "--separator=\n",
            "--title=Open scans",
            "--filename=" + folder + "/",
            "--file-filter=Scans and scenes | " + patterns(),
            "--file-filter=All files | *"};
}

std::vector<std::string> NativeDialog::folder_command(const std::string& program, const std::string& folder) {
    if (program == "kdialog")
        return {"kdialog", "--title", "Folder of the scans", "--getexistingdirectory", folder};
    return {"zenity", "--file-selection", "--directory", "--title=Folder of the scans",
            "--filename=" + folder + "/"};
}

std::vector<std::string> NativeDialog::chosen(const std::string& output) {
    std::vector<std::string> lines;
    std::istringstream text(output);
    for (std::string line; std::getline(text, line);)
        if (!line.empty()) lines.push_back(line);
    return lines;
}

NativeDialog::~NativeDialog() {
    if (pipe_ >= 0) ::close(pipe_);
    if (pid_ <= 0) return;
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
}

bool NativeDialog::start(const std::vector<std::string>& command) {
    if (open()) return true;
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) != 0) return false;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    const int failure = spawn(command, actions, pid_);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    if (failure != 0) {
        ::close(ends[0]);
        pid_ = -1;
        return false;
    }
    pipe_ = ends[0];
    output_.clear();
    return true;
}

std::optional<std::vector<std::string>> NativeDialog::poll() {
    if (!open()) return std::nullopt;
    std::array<char, 4096> buffer{};
    for (ssize_t n = 0; pipe_ >= 0;) {
        n = read(pipe_, buffer.data(), buffer.size());
        if (n < 0 && (errno == EAGAIN || errno == EINTR)) return std::nullopt;
        if (n > 0 && output_.size() < kMostOutput) output_.append(buffer.data(), static_cast<size_t>(n));
        if (n > 0) continue;
        ::close(pipe_);
        pipe_ = -1;
    }
    if (waitpid(pid_, nullptr, WNOHANG) == 0) return std::nullopt;
    pid_ = -1;
    return chosen(output_);
}

}  // namespace lucarne::viewer
