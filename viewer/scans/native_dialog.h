#pragma once

#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace lucarne::viewer {

/// The desktop's own dialog for opening files: zenity (GNOME and most) or kdialog (KDE), as a process beside
/// the window, which goes on drawing.
class NativeDialog {
 public:
    /// Its programs that are installed, the desktop's own first.
    static std::vector<std::string> programs();
    /// The program and its arguments.
    static std::vector<std::string> command(const std::string& program, const std::string& folder);
    /// The lines of what it printed.
    static std::vector<std::string> chosen(const std::string& output);

    NativeDialog() = default;
    ~NativeDialog();
    NativeDialog(const NativeDialog&) = delete;
    NativeDialog& operator=(const NativeDialog&) = delete;

    bool open() const { return pid_ > 0; }
    /// False where it cannot be started.
    bool start(const std::vector<std::string>& command);
    /// What was chosen, once the dialog is closed; nothing chosen is an empty list. Never waits.
    std::optional<std::vector<std::string>> poll();

 private:
    pid_t pid_ = -1;
    int pipe_ = -1;
    std::string output_;
};

}  // namespace lucarne::viewer
