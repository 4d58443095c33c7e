#pragma once

#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace lucarne::viewer {

/// The desktop's dialog for opening files or choosing a folder: zenity (GNOME and most others) or kdialog
/// (KDE), run as a separate process. The window keeps drawing meanwhile.
class NativeDialog {
 public:
    /// Returns the installed dialog programs, the running desktop's own first.
    static std::vector<std::string> programs();
    /// Returns the program and its arguments, to choose scans, or the folder where some are.
    static std::vector<std::string> command(const std::string& program, const std::string& folder);
    static std::vector<std::string> folder_command(const std::string& program, const std::string& folder);
    /// Splits the program's output into lines.
    static std::vector<std::string> chosen(const std::string& output);

    NativeDialog() = default;
    ~NativeDialog();
    NativeDialog(const NativeDialog&) = delete;
    NativeDialog& operator=(const NativeDialog&) = delete;

    bool open() const { return pid_ > 0; }
    /// Starts the dialog. Returns false if it cannot be started.
    bool start(const std::vector<std::string>& command);
    /// Returns the chosen files once the dialog is closed; an empty list if nothing was chosen. Never waits.
    std::optional<std::vector<std::string>> poll();

 private:
    pid_t pid_ = -1;
    int pipe_ = -1;
    std::string output_;
};

}  // namespace lucarne::viewer
