#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tests/processes.h"

namespace lucarne::test {

/// An X server without a screen (Xvfb), and a user's hands on it (xdotool).
class VirtualScreen {
 public:
    static bool installed() { return test::installed("Xvfb") && test::installed("xdotool"); }

    /// Starts the server with a free number. `folder` is for its file and must outlive it.
    VirtualScreen(int width, int height, const std::filesystem::path& folder) : folder_(folder) {
        const std::string number = folder_ / "display";
        server_.emplace("Xvfb -displayfd 3 -screen 0 " + std::to_string(width) + "x" +
                        std::to_string(height) + "x24 -nolisten tcp -noreset 3>" + number + " 2>/dev/null");
        const bool started = eventually(
            [&] { return !server_->running() || bytes_of(number).find('\n') != std::string::npos; });
        const std::string written = bytes_of(number);
        if (started && !written.empty()) number_ = written.substr(0, written.size() - 1);
    }

    bool started() const { return !number_.empty(); }
    /// Returns the setting of the variable for programs on this screen, and a space.
    std::string display() const { return "DISPLAY=:" + number_ + " "; }
    Outcome xdo(const std::string& command) const {
        return shell(display() + "timeout -s KILL 600 xdotool " + command);
    }
    /// Returns the start of a command that runs the viewer on this screen in the folder, with its settings
    /// there.
    std::string environment() const {
        // LeakSanitizer would report leaks of X's and Mesa's drivers. They are unloaded by then, so they have
        // no module name that a suppression could match.
        return "env -C " + folder_.string() + " " + display() +
               "LUCARNE_CONFIG=" + (folder_ / "config").string() + " ASAN_OPTIONS=detect_leaks=0 ";
    }

 private:
    std::filesystem::path folder_;
    std::optional<Background> server_;
    std::string number_;
};

}  // namespace lucarne::test
