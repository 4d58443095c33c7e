// A viewer in a real window: an X server without a screen (Xvfb), driven as a user would (xdotool).
#pragma once

#include <chrono>
#include <cmath>
#include <optional>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <signal.h>

#include "io/image/image.h"
#include "tests/viewer/program.h"

namespace lucarne::test {

inline constexpr int kWidth = 480, kHeight = 360;  ///< of the window
/// Ends a test that hangs; not a measurement.
inline constexpr auto kPatience = std::chrono::seconds(120);

inline bool installed(const std::string& program) {
    return shell("command -v " + program).code == 0;
}

/// Polls until `there` holds. Returns false after kPatience.
template <class Condition>
bool eventually(const Condition& there) {
    const auto end = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < end) {
        if (there()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
}

/// A background program that is ended together with this object.
class Background {
 public:
    explicit Background(const std::string& command) {
        pid_ = fork();
        if (pid_ == 0) {
            execl("/bin/sh", "sh", "-c", ("exec " + command).c_str(), nullptr);
            _exit(127);
        }
    }
    ~Background() {
        if (!running()) return;
        kill(pid_, SIGTERM);
        if (eventually([&] { return !running(); })) return;
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    Background(const Background&) = delete;
    Background& operator=(const Background&) = delete;

    bool running() {
        int status = 0;
        if (pid_ > 0 && waitpid(pid_, &status, WNOHANG) == pid_) {
            code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
            pid_ = -1;
        }
        return pid_ > 0;
    }
    std::optional<int> code() const { return code_; }
    pid_t pid() const { return pid_; }  ///< -1 once it has ended

 private:
    pid_t pid_ = -1;
    std::optional<int> code_;
};

inline double difference(const io::Image8& a, const io::Image8& b) {  ///< mean difference, of 255
    double sum = 0;
    for (size_t i = 0; i < a.bytes.size(); ++i) sum += std::abs(double(a.bytes[i]) - double(b.bytes[i]));
    return sum / static_cast<double>(a.bytes.size());
}

inline double deviation(const io::Image8& image) {  ///< standard deviation, of 255
    double sum = 0, squares = 0;
    for (const uint8_t byte : image.bytes) {
        sum += byte;
        squares += double(byte) * byte;
    }
    const double n = static_cast<double>(image.bytes.size());
    return std::sqrt(squares / n - (sum / n) * (sum / n));
}

class ViewerWindow : public testing::Test {
 protected:
    void SetUp() override {
        if (!installed("Xvfb") || !installed("xdotool")) GTEST_SKIP() << "needs Xvfb and xdotool";
        const std::string number = folder_ / "display";
        server_.emplace("Xvfb -displayfd 3 -screen 0 1000x750x24 -nolisten tcp -noreset 3>" + number +
                        " 2>/dev/null");
        ASSERT_TRUE(eventually([&] { return bytes_of(number).find('\n') != std::string::npos; }))
            << "Xvfb does not start";
        display_ = "DISPLAY=:" + bytes_of(number).substr(0, bytes_of(number).size() - 1) + " ";
        cache_ = make_cornell(folder_);
    }

    void start(const std::string& more = "") { start_with(cache_ + more); }
    /// Starts `lucarne view` with `arguments` and environment `variables`.
    void start_with(const std::string& arguments, const std::string& variables = "") {
        // LeakSanitizer would report leaks of X's and Mesa's drivers. They are unloaded by then, so they have
        // no module name that a suppression could match.
        const std::string environment = display_ + "LUCARNE_CONFIG=" + (folder_ / "config") +
                                        " ASAN_OPTIONS=detect_leaks=0 " + variables + " ";
        viewer_.emplace("env -C " + folder_.path().string() + " " + environment + LUCARNE_BINARY + " view " +
                        arguments + " --engine direct --size " + std::to_string(kWidth) + "x" +
                        std::to_string(kHeight) + " 2>>" + (folder_ / "log"));
        ASSERT_TRUE(
            eventually([&] { return !viewer_->running() || xdo("search --name 'Lucarne - '").code == 0; }));
        ASSERT_TRUE(viewer_->running()) << "it ended at once";
    }
    std::string log() const { return bytes_of(folder_ / "log"); }
    Outcome xdo(const std::string& command) const { return shell(display_ + "xdotool " + command); }
    void drag(int button, int from_x, int from_y, int to_x, int to_y) const {
        const auto at = [](int x, int y) { return std::to_string(x) + " " + std::to_string(y); };
        std::string moves = "mousemove " + at(from_x, from_y) + " sleep 0.3 mousedown " +
                            std::to_string(button) + " sleep 0.3";
        for (int step = 1; step <= 5; ++step)
            moves += " mousemove " +
                     at(from_x + (to_x - from_x) * step / 5, from_y + (to_y - from_y) * step / 5) +
                     " sleep 0.1";
        EXPECT_EQ(xdo(moves + " mouseup " + std::to_string(button)).code, 0);
    }

    /// Returns the picture at rest: saves it with the viewer's key until it is complete and `wanted` accepts
    /// it.
    template <class Wanted>
    std::optional<io::Image8> picture(const Wanted& wanted) {
        std::optional<io::Image8> result;
        eventually([&] {
            if (!viewer_->running()) return true;
            const std::string file = folder_ / "lucarne-0001.png";
            std::error_code ignored;
            std::filesystem::remove(file, ignored);
            // The log reports a written picture; reports of earlier ones do not count.
            const size_t before = times_saved();
            xdo("key F12");
            for (int i = 0; i < 40 && times_saved() == before; ++i)
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
            if (times_saved() == before) return false;
            const auto saved = io::read_png(file);
            if (!saved || saved->width != kWidth * scale_ * resolution_ ||
                saved->height != kHeight * scale_ * resolution_ || !wanted(*saved))
                return false;
            result = *saved;
            return true;
        });
        return result;
    }
    size_t times_saved() const {
        const std::string said = log();
        constexpr std::string_view kName = "lucarne-0001.png";
        size_t times = 0;
        for (size_t at = said.find(kName); at != said.npos; at = said.find(kName, at + 1)) ++times;
        return times;
    }
    /// Whether the last saved picture had all its points, and nothing moved.
    bool whole() const {
        const std::string said = log();
        const size_t at = said.rfind("lucarne-0001.png");
        return at != std::string::npos && said.find("sketch", at) == std::string::npos;
    }
    /// Whether `image` is nearer to `to` than to `than`. Pictures of the same view differ only at edges,
    /// however far both are averaged.
    static bool nearer(const io::Image8& image, const io::Image8& to, const io::Image8& than) {
        return difference(image, to) < difference(image, than) / 4;
    }
    static bool lit(const io::Image8& image) { return deviation(image) > 10; }

    TemporaryFolder folder_;
    std::optional<Background> server_, viewer_;
    std::string display_, cache_;
    uint32_t scale_ = 1;     ///< screen pixels along a side of a desktop's unit
    double resolution_ = 1;  ///< share of the window's width and height at which pictures are made (--scale)
};

/// A window under a small window manager (openbox), which adds frames, sets the focus and requests closing.
class ManagedWindow : public ViewerWindow {
 protected:
    void SetUp() override {
        if (!installed("openbox")) GTEST_SKIP() << "needs openbox";
        ViewerWindow::SetUp();
        if (IsSkipped() || HasFatalFailure()) return;
        manager_.emplace("env " + display_ + "openbox --sm-disable 2>/dev/null");
        ASSERT_TRUE(eventually([&] { return xdo("get_num_desktops").code == 0; })) << "no window manager";
    }
    /// Returns the title of the focused window, or an empty text.
    std::string title() const {
        const Outcome name = xdo("getactivewindow getwindowname");
        return name.code == 0 ? name.output : "";
    }
    bool title_comes(const std::string& part) const {
        return eventually([&] { return title().find(part) != std::string::npos; });
    }

    std::optional<Background> manager_;
};

}  // namespace lucarne::test
